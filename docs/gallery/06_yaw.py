"""
A camera that was bumped
========================

The right camera looks 0.05° further right than its calibration says. Pixels come from the true rig, points
are computed with the assumed one: near points come out right, far ones do not.
"""

import matplotlib.pyplot as plt
import numpy as np

import rigsim

assumed = rigsim.read_rig("oak-d")
true = rigsim.Perturbation(yaw_rad=np.radians(0.05)).apply(assumed)

z_m = np.linspace(0.5, 6, 100)
points = np.outer(z_m, [0, 0, 1])
uv_left, uv_right = true.project(points)
measured_m = rigsim.triangulate(assumed, uv_left, uv_right)[:, 2]

plt.plot(z_m, measured_m, label="measured")
plt.plot(z_m, z_m, "k:", label="true")
plt.xlabel("true distance, m")
plt.ylabel("depth, m")
plt.legend()
