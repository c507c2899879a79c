"""
Far away, too far is worse than too near
========================================

A disparity that is half a pixel too small puts a point much farther off than one that is half a pixel too
large brings it near. The two bounds are exact, not one standard deviation to either side.
"""

import matplotlib.pyplot as plt
import numpy as np

import rigsim

lens = rigsim.Intrinsics.from_hfov(640, 480, hfov_deg=70)
rig = rigsim.StereoRig.rectified(lens, baseline_m=0.05)
z_m = np.linspace(1, 20, 200)
nearest_m, farthest_m = rigsim.depth_bounds(rig, np.outer(z_m, [0, 0, 1]), 0.5)

plt.fill_between(z_m, nearest_m, farthest_m, alpha=0.3, label="disparity off by up to 0.5 px")
plt.plot(z_m, z_m, "k", label="true distance")
plt.xlabel("true distance, m")
plt.ylabel("measured depth, m")
plt.legend()
