"""A measured pair for people."""
