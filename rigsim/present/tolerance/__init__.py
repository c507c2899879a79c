"""A tolerance study for people."""
