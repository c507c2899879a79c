"""What does happen: MuJoCo scenes, rendering, rays and ground truth."""
