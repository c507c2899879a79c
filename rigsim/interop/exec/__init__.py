"""Programs that triangulate: what they are given, and what is taken from them."""
