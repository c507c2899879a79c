"""A sweep for people."""
