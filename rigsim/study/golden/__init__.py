"""Golden results: what a command gave once, and what has moved since."""
