"""A calibration of people's own pictures, and what it is worth."""
