"""Names that help texts list, without loading what has them; made from the registries by tools/lists.py."""

# [[[cog
# import lists
# cog.outl(lists.for_help())
# ]]]
TRIANGULATORS = "optimal, rectified, dlt, midpoint, cv2"
GEOMETRIES = (
    "rectified, doffs, off-centre, non-square, near, far, verged, rolled, vertical, forward, unequal, "
    "distorted, pincushion, toe-out, convergent, from the side, left-handed, upside-down, on its side, "
    "portrait, diagonal, backward, alike, wide, close-up, aerial, remote"
)
RIG_FORMATS = "opencv, ros, kalibr, basalt, middlebury, colmap, mjcf, nerfstudio, mrcal"
DATASET_FORMATS = "middlebury, kitti, opencv, colmap"
# [[[end]]]
