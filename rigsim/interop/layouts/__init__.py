"""Layouts of data sets: one file each, and a line of the registry."""
