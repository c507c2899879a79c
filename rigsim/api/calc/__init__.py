"""Closed forms as facts: a point, a distance, a rig's limits, each number with its name, unit and meaning."""
