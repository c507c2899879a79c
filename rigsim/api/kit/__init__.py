"""What the use cases share."""
