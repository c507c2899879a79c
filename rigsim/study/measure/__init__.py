"""Somebody's own pair of pictures."""
