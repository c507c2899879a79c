"""Calibration files, a module a format."""
