"""A design for people."""
