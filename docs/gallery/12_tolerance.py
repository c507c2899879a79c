"""
What must be held tightest
==========================

Five hundred built rigs of calibrated cameras: which quantity makes which depth error, and how many are good.
"""

import rigsim

found = rigsim.tolerance(
    "oak-d", tolerance_class="calibrated", depth_error_pct=3, range_m=(0.5, 3), rigs=500, points=100
)
figure = found.figure()
print(found.headline)
found.table[["quantity", "unit", "tolerance", "variance_share", "source"]].head(6)
