"""
Sweep a baseline
================

Predicted by closed forms, and simulated on points of a scene's surfaces. The two must agree.
"""

import matplotlib.pyplot as plt

import rigsim

lens = rigsim.Intrinsics.from_hfov(640, 480, hfov_deg=70)
rig = rigsim.StereoRig.rectified(lens, baseline_m=0.1)
grid = rigsim.RigGrid(rig, baselines_m=(0.06, 0.12, 0.25))
plan = rigsim.Plan(scene="boards", range_m=(1, 3), n_points=200, n_trials=30, measure="none")
rows = rigsim.sweep(grid, plan).rows

plt.plot(rows["baseline_mm"], rows["predicted_depth_rmse_mm"], "-", label="predicted")
plt.plot(rows["baseline_mm"], rows["depth_rmse_mm"], "o", label="simulated")
plt.xlabel("baseline, mm")
plt.ylabel("RMS depth error at 1 to 3 m, mm")
plt.ylim(0)
plt.legend()

rows[["baseline_mm", "predicted_depth_rmse_mm", "depth_rmse_mm", "visible_fraction", "agreement"]].round(2)
