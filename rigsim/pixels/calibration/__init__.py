"""Calibration by OpenCV."""
