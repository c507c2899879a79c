"""Where the right camera looks and stands, on top of baseline and vergence: one file an axis."""
