"""What a rig is: poses, lenses, two cameras, what differs and what is noisy."""
