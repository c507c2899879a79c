"""Calibrating a built rig once more: what is looked at, and what is solved for."""
