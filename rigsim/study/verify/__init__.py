"""Holding any triangulator on cases with known answers."""
