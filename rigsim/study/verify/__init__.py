"""Holding any triangulator against cases whose answer is known."""
