"""Documents from results."""
