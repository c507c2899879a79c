"""
From a requirement to a rig
===========================

10 mm at 3 m, and half of the left image shared at 0.5 m. Formulas only: leave out ``proof=False``, and
the rig is rendered, simulated and measured.
"""

import rigsim

found = rigsim.design(
    range_m=(0.5, 3), depth_error_mm=10, at_m=3, resolutions_px=[(1280, 960), (1920, 1080)], proof=False
)
figure = found.figure()
print(found.headline)
found.table[["baseline_mm", "focal_px", "width_px", "height_px", "hfov_deg", "depth_error_far_mm"]].head()
