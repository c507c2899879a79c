"""
Lens distortion ignored
=======================

A lens of k1 = -0.1, and a program that takes it for a pinhole: the depth of a flat wall at 2 m.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import rigsim

pinhole = rigsim.Intrinsics.from_hfov(1280, 960, hfov_deg=70)
lens = replace(pinhole, lens=rigsim.BrownConrady(k1=-0.1))
true = rigsim.StereoRig.rectified(lens, baseline_m=0.12)
assumed = rigsim.StereoRig.rectified(pinhole, baseline_m=0.12)

x, y = np.meshgrid(np.linspace(-1.1, 1.1, 60), np.linspace(-0.9, 0.9, 50))
wall = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 2.0)])
depth_m = rigsim.triangulate(assumed, *true.project(wall))[:, 2].reshape(x.shape)

plt.pcolormesh(x, y, 1000 * (depth_m - 2), cmap="RdBu", vmin=-400, vmax=400)
plt.gca().invert_yaxis()
plt.colorbar(label="depth error, mm")
plt.xlabel("x on the wall, m")
plt.ylabel("y on the wall, m")
