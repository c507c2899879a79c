"""
Where a point may lie
=====================

The error of a triangulated point is a needle along the line of sight. Seen from above, with the
ellipses (three standard deviations) ten times as large as they are.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Ellipse

import rigsim

rig = rigsim.read_rig("oak-d")
x, z = np.meshgrid(np.linspace(-0.9, 0.9, 5), np.linspace(0.8, 2.0, 4))
points = np.column_stack([x.ravel(), 0 * x.ravel(), z.ravel()])
covariance = rigsim.predict_covariance(rig, points, rigsim.PixelNoise(0.25))

axes = plt.figure(figsize=(6, 5)).add_subplot(aspect="equal")
for point, matrix in zip(points, covariance[:, ::2, ::2], strict=True):
    variance, direction = np.linalg.eigh(matrix)
    width, height = 10 * 2 * 3 * np.sqrt(variance)
    angle = np.degrees(np.arctan2(direction[1, 0], direction[0, 0]))
    axes.add_patch(Ellipse(point[::2], width, height, angle=angle, alpha=0.6))
axes.plot([0, rig.baseline_m], [0, 0], "k^", label="cameras")
axes.set(xlim=(-1.3, 1.3), ylim=(-0.1, 2.4), xlabel="x, m", ylabel="z, m")
axes.legend()
