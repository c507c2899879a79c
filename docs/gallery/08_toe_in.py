"""
Toe-in
======

Turned towards each other, the cameras share more of what is near. The depth error on the axis hardly changes.
"""

import matplotlib.pyplot as plt
import numpy as np

import rigsim

lens = rigsim.Intrinsics.from_hfov(1280, 960, hfov_deg=60)
u, v = np.meshgrid(np.linspace(0, 1279, 80), np.linspace(0, 959, 60))
rays = np.column_stack([lens.normalize(np.column_stack([u.ravel(), v.ravel()])), np.ones(u.size)])
z_m = np.linspace(0.3, 3, 60)

for toe_in_deg in (0, 10, 20):
    rig = rigsim.StereoRig.verged(lens, 0.2, toe_in_deg)
    shared = [np.mean(lens.contains(rig.project(rays * z)[1])) for z in z_m]
    plt.plot(z_m, 100 * np.array(shared), label=f"{toe_in_deg}°")
plt.xlabel("distance, m")
plt.ylabel("share of the left image that both see, %")
plt.legend(title="toe-in")
