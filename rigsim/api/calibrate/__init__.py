"""Calibrations that are planned, or made of pictures, and what they leave."""
