"""What can be bought: cameras and sensors by name."""
