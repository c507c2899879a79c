"""Triangulators side by side."""
