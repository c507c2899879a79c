"""
Sweep a baseline
================

Predicted by closed forms, and simulated on points of a scene's surfaces. The two must agree.
"""

import rigsim

found = rigsim.sweep(
    rig="oak-d",
    baselines_mm=[50, 100, 200],
    resolutions_px=(640, 400),
    scene="boards",
    range_m=(1, 3),
    points=200,
    trials=30,
    measure="none",
    supersample=1,
)
figure = found.figure()
print(found.headline)
found.table[["baseline_mm", "predicted_depth_rmse_mm", "depth_rmse_mm", "visible_fraction", "agreement"]]
