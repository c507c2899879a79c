"""Ground truth: rays, surfaces and the points on them."""
