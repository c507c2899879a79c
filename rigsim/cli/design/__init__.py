"""`rigsim design`."""
