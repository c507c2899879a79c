"""What the pixels say: corners, patches and dense disparities, found in two images and nothing else.

This room sees images, a rig's calibration and a board's rows and columns; never the truth, never a
scene. It is the only one that imports OpenCV, the extra ``vision``.
"""
