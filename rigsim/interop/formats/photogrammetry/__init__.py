"""Calibrations of programs that reconstruct scenes from pictures."""
