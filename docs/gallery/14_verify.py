"""
A mistake, named
================

A triangulation that takes the right image for the left one, held to cases whose answer is known.
"""

import rigsim


def mixed_up(rig, uv_left, uv_right):
    """The images are exchanged."""
    return rigsim.triangulate(rig, uv_right, uv_left)


found = rigsim.verify(mixed_up, cases=["verged", "unequal"], scenes=[])
figure = found.figure()
print(found.headline)
found.table[["case", "kind", "rows", "status", "efficiency"]]
