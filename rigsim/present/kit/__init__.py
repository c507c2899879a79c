"""What pages, figures and consoles share."""
