"""Command line: words to one call."""
