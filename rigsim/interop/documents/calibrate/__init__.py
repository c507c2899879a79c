"""The documents of calibrations."""
