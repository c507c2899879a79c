"""What a sweep can vary: one file an axis, and the registry that names them all."""
