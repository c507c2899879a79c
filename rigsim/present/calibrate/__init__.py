"""A planned calibration, and one of pictures, for people."""
