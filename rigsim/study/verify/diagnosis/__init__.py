"""Which mistake explains wrong answers."""
