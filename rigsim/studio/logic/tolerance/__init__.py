"""The Tolerance page: one built rig, and the ranking of a class."""
