"""Folders, tables and data sets on disk."""
