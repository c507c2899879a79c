"""Calibrations of OpenCV's functions, under whichever names people store what these return."""
