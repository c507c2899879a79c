"""
Least squares, midpoint and DLT
===============================

The same noisy pixels of far points, triangulated by three methods. The middle of the shortest line between
the two rays lies too near when the disparity comes down to its noise; least squares and DLT stay right.
"""

import matplotlib.pyplot as plt
import numpy as np

import rigsim

lens = rigsim.Intrinsics.from_hfov(1280, 960, hfov_deg=70)
rig = rigsim.StereoRig.rectified(lens, baseline_m=0.05)
noise = rigsim.PixelNoise(0.5)
z_m = np.linspace(2, 30, 15)

for method, mark in (("optimal", "o-"), ("dlt", "x"), ("midpoint", "s-")):
    rng = np.random.default_rng(0)  # the same noise for all
    medians = []
    for z in z_m:
        uv_left, uv_right = noise.apply(*rig.project(np.tile([0.3 * z, 0.2 * z, z], (4000, 1))), rng)
        medians.append(np.nanmedian(rigsim.triangulate(rig, uv_left, uv_right, method)[:, 2]))
    plt.plot(z_m, medians, mark, label=method)
plt.plot(z_m, z_m, "k:", label="true")
plt.xlabel("true distance, m")
plt.ylabel("median measured depth, m")
plt.legend()
