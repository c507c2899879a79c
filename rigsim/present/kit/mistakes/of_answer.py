"""Mistakes with what comes back, in words."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

_AXES = "({axes}) comes back for (x, y, z): "
_OPENCV = "; OpenCV's axes are x right, y down, z forward."

ANSWER: Sentences = {
    "right-frame": "Points come back in the right camera's frame, not in the left camera's: map them with "
    "right_from_left's inverse, or swap the roles.",
    "rig-frame": "Points come back in the rig's frame, not in the left camera's: its origin is the middle of "
    "the baseline, its axes look halfway.",
    "rig-frame: half missing": "Points come back in a frame whose origin is the middle of the baseline, not "
    "in the left camera's: half of it is missing.",
    "rig-frame: half too much": "Points come back in a frame half a baseline away, not in the left camera's: "
    "half of it has the wrong sign.",
    "rectified-frame": "Points come back in the rectified left camera's frame, not in the left camera's: "
    "rotate them back by the transpose of R1.",
    "rectified-frame: wrong way": "Points come back in a rectified frame, not in the left camera's: they "
    "were rotated back the wrong way.",
    "transformed-wrongly": "Points are mapped by right_from_left's inverse although they are in the left "
    "frame already.",
    "transformed-wrongly: R": "Points are rotated by R once too often.",
    "transformed-wrongly: transpose of R": "Points are rotated by the transpose of R once too often.",
    "transformed-wrongly: place": "Points are measured from the right camera's place, along the left "
    "camera's axes.",
    "transformed-wrongly: t": "t is added to points that are in the left frame already.",
    "ray-length-for-depth": "Depth and length of the ray are mixed up: z is the distance to the point.",
    "ray-length-for-depth: along the ray": "Depth and length of the ray are mixed up: the point lies at the "
    "depth's distance along its ray.",
    "ray-length-for-depth: scaled": "Depth and length of the ray are mixed up: the ray, scaled to z = 1, is "
    "made as long as the point is far.",
    "inverse-depth": "1/z comes back for z.",
    "disparity-for-depth": "z is the disparity in pixels.",
    "not-times-depth": "x and y are not multiplied by z: (x/z, y/z, z) comes back.",
    "not-times-depth: lost": "(x/z, y/z, 1) comes back: the depth is lost.",
    "not-times-depth: length 1": "Directions of length 1 come back: the depth is lost.",
    "pixels-for-metres": "x and y are the left image's pixels: (u, v, z) comes back.",
    "not-divided-by-focal": "x and y are not divided by the focal length.",
    "principal-point-missing: x and y": "x and y are made without the principal point; the depth is right.",
    "xy-from-right-pixel": "x and y are made of the right image's pixel and the left camera's depth.",
    "depth-from-right": "z is the depth in the right camera's frame.",
    "fx-for-fy: y alone": "y is divided by fx where fy is meant; x and the depth are right.",
    "fy-for-fx: x alone": "x is divided by fy where fx is meant; y and the depth are right.",
    "distortion-ignored: x and y": "x and y are made of the pixel as it was seen, distortion included; the "
    "depth is right.",
    "behind-in-front": "Points behind the cameras come back in front of them: a disparity's absolute value "
    "is taken.",
    "behind-in-front: z": "The absolute value of z is taken: points behind the cameras come back in front.",
    "nothing-found: ever": "Nothing is ever found: every row is NaN or behind a camera.",
    "opengl-axes": _AXES + "y and z have the opposite sign, as in OpenGL (y up, z backwards)" + _OPENCV,
    "flipped-y": _AXES + "y has the opposite sign: it points down here" + _OPENCV,
    "flipped-x": _AXES + "x has the opposite sign" + _OPENCV,
    "flipped-z": _AXES + "z has the opposite sign: points lie behind the camera" + _OPENCV,
    "negated-points": _AXES + "all three coordinates have the opposite sign" + _OPENCV,
    "x-y-exchanged": _AXES + "x and y are exchanged: row and column are mixed up" + _OPENCV,
    "ros-axes": _AXES + "axes are forward, left, up (ROS REP 103)" + _OPENCV,
    "axes-permuted": _AXES + "the axes are another convention's" + _OPENCV,
}
"""In which frame the points are, and what their numbers mean."""
