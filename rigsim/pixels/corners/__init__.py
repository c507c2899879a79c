"""Checker boards and their corners."""
