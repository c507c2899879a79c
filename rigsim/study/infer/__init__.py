"""From depth errors back to disparity noise."""
