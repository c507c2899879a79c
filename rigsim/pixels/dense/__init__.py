"""Dense disparities, and how wrong they are."""
