"""Mistakes with the right camera's pose, in words."""

from __future__ import annotations

from rigsim.present.kit.sayings import Sentences

POSE: Sentences = {
    "inverse-pose": "The pose is used the wrong way round: right_from_left (x_right = R x_left + t) is taken "
    "for its inverse.",
    "transposed-rotation": "R is transposed: a row-major matrix read by columns, or the inverse rotation "
    "with the right t.",
    "transposed-rotation: rays": "The right camera's rays are turned by R where its transpose is meant; its "
    "place is right.",
    "baseline-sign": "t has the wrong sign: the right camera is put on the left camera's other side.",
    "centre-for-translation": "t is taken for the right camera's place (-R^T t), or its place for t.",
    "centre-for-translation: R^T t": "R^T t stands for t: the translation is rotated once too often.",
    "centre-for-translation: R t": "R t stands for t: the translation is rotated once too often.",
    "centre-for-translation: no R^T": "The camera's place lacks its R^T: -t is used where -R^T t is meant.",
    "rotation-ignored": "The rotation between the cameras is ignored: R is taken for the identity.",
    "small-angle": "The rotation is taken to first order, 1 + [w]x: that holds for small angles alone.",
    "baseline-along-x-only": "Only the x component of t is used: the right camera is taken to sit exactly "
    "beside the left one.",
    "baseline-along-x-only: whole length": "The whole length of t is laid along x: the right camera is taken "
    "to sit exactly beside the left one.",
    "unit-baseline": "The baseline's length is lost: t is scaled to length 1, as recoverPose gives it.",
    "degrees-for-radians: too large": "The rotation is built from degrees where radians are meant, or the "
    "other way round: the angle is 57.3 times too large.",
    "degrees-for-radians: too small": "The rotation is built from degrees where radians are meant, or the "
    "other way round: the angle is 57.3 times too small.",
    "centre-for-translation: -R t": "The right camera's place is computed as -R t where -R^T t is meant.",
    "quaternion-order": "The quaternion's scalar is looked for at the wrong end: (w, x, y, z) and (x, y, z, "
    "w) differ.",
    "baseline-component-lost": "Component {axis} of t is lost or zero.",
    "degrees-for-radians: Euler": "The rotation is built from degrees where radians are meant, or the other "
    "way round (Euler angles {order}).",
    "euler-order": "The rotation's angles are put together in another order than they were taken apart: "
    "{read} and {written}.",
    "baseline-sign: component": "Component {axis} of t has the wrong sign.",
    "rotation-angle: sign": "The rotation about {axis} has the wrong sign.",
    "rotation-angle: lost": "The rotation about {axis} is lost.",
    "rotation-angle: alone": "The rotation about {axis} alone is used.",
    "euler-order: rotation vector": "The rotation vector's three numbers are taken for Euler angles "
    "({order}).",
}
"""Where the right camera stands."""
