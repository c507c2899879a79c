"""What the scene's pictures leave out, and what is odd about where a rig sits: named, and the same to rays and GL."""
