"""Corners that other programs found."""
