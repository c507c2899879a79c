"""From requirements to a rig."""
