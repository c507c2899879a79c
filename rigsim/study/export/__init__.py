"""Rigs made fit for other programs."""
