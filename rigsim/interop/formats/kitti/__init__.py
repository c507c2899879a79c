"""KITTI's calibrations."""
