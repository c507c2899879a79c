"""Calibrations: planned, proved, and made of people's own pictures."""
