"""
Depth error over distance
=========================

A rig's depth error grows with the square of the distance. The closed form gives it in a moment.
"""

import matplotlib.pyplot as plt
import numpy as np

import rigsim

noise = rigsim.PixelNoise(0.25)  # standard deviation of each pixel coordinate, px
z_m = np.linspace(0.5, 5, 50)
axis = np.outer(z_m, [0, 0, 1])  # points on the left camera's optical axis

for name in ("oak-d", "d455", "zed-2i"):
    std_m = rigsim.predict_depth_std(rigsim.read_rig(name), axis, noise)
    plt.plot(z_m, 1000 * std_m, label=name)

plt.xlabel("distance, m")
plt.ylabel("depth error, mm, one standard deviation")
plt.legend()
