"""
What a wrong calibration does
=============================

The depth error that each small miscalibration makes on the optical axis, to first order.
"""

import matplotlib.pyplot as plt
import numpy as np

import rigsim

rig = rigsim.read_rig("d455")
z_m = np.linspace(0.5, 5, 50)
sensitivity = rigsim.depth_sensitivity(rig, np.outer(z_m, [0, 0, 1]))

amounts = {
    "yaw_rad": (np.radians(0.01), "yaw 0.01°"),
    "right_cx_px": (0.1, "right principal point 0.1 px"),
    "right_focal_px": (0.5, "right focal length 0.5 px"),
    "baseline_m": (0.0001, "baseline 0.1 mm"),
}
for name, (amount, label) in amounts.items():
    error_mm = 1000 * np.abs(sensitivity[name] * amount)
    plt.plot(z_m, np.where(error_mm > 1e-6, error_mm, np.nan), label=label)
plt.yscale("log")
plt.xlabel("distance, m")
plt.ylabel("depth error, mm")
plt.legend()
