"""The triangulators, one module a kind."""
