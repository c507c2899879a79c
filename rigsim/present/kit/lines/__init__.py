"""Lines with their names beside them."""
