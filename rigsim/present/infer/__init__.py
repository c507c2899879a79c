"""An inference for people."""
