"""A verification for people."""
