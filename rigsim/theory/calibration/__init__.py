"""What a calibration leaves: the adjustment of board pictures, its covariance, what it does to depths."""
