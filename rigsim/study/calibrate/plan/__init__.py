"""Which board, held where, how many times, and what that leaves."""
