"""The other two witnesses of a planned calibration: recalibrated many times, and rendered and calibrated."""
