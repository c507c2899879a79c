"""Calibrations as the makers of cameras and of their tools write them."""
