"""What tests of calibrations share."""
