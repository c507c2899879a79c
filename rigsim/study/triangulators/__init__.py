"""Triangulators by name, and other people's in a process of their own."""
