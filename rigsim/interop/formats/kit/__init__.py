"""What reads any calibration: files, what a person says beside them, and which format they are of."""
