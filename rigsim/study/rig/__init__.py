"""What a rig is, and what is odd about it."""
