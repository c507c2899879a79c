"""`rigsim calc`: closed forms."""
