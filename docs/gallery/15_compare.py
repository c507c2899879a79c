"""
Methods side by side
====================

How near three methods come to the best that noise allows, each on the same pixels.
"""

import rigsim

found = rigsim.compare(
    ["optimal", "dlt", "midpoint"],
    geometries=["rectified", "far", "unequal"],
    noises_px=[0.25, 0.5, 1],
    points=2000,
)
figure = found.figure()
print(found.headline)
found.table[["geometry", "noise_px", "triangulator", "pixel_error_over_bound", "failed_share"]]
