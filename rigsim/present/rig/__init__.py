"""What a rig is, for people."""
