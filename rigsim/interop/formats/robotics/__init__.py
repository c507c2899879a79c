"""Calibrations of robots' cameras: ROS, Kalibr, Basalt, EuRoC."""
