"""
Least squares, midpoint and DLT
===============================

One camera stands ahead of the other. The same noisy pixels, triangulated by three methods.
"""

import matplotlib.pyplot as plt
import numpy as np

import rigsim

lens = rigsim.Intrinsics.from_hfov(1280, 960, hfov_deg=70)
ahead = rigsim.Pose(np.eye(3), [-0.05, 0.0, -0.3])  # the right camera, 50 mm aside and 300 mm ahead
rig = rigsim.StereoRig(lens, lens, ahead)

points = np.tile([0.5, 0.3, 2.5], (20000, 1))
uv_left, uv_right = rig.project(points)
rng = np.random.default_rng(0)
uv_left, uv_right = rigsim.PixelNoise(2.0).apply(uv_left, uv_right, rng)

for method in ("optimal", "dlt", "midpoint"):
    z_m = rigsim.triangulate(rig, uv_left, uv_right, method)[:, 2]
    label = f"{method}: mean {1000 * (np.nanmean(z_m) - 2.5):+.1f} mm"
    plt.hist(1000 * (z_m - 2.5), 120, range=(-200, 200), histtype="step", label=label)
plt.xlabel("depth error, mm")
plt.yticks([])
plt.legend()
