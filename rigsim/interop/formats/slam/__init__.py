"""Settings of programs that find their way by cameras: VINS-Fusion, ORB-SLAM."""
