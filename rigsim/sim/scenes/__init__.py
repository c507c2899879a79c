"""Scenes: found, checked, read, and given cameras."""
