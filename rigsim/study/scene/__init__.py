"""What experiments in scenes share."""
