"""What of a rig is off together: all that one calibration found."""
