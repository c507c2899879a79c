"""The depth error at a distance, on the left camera's optical axis."""

from __future__ import annotations

import numpy as np

from rigsim.api.calc.about import about
from rigsim.api.calc.fact import Assumed, DepthAnswer, Fact, if_seen, whose
from rigsim.api.calc.rows import row_facts
from rigsim.rig.stereo import StereoRig


def calc_depth(rig: StereoRig, depth_mm: float, assumed: Assumed) -> DepthAnswer:
    """Predict the depth error at a distance.

    Args:
        rig: the rig.
        depth_mm: distance Z along the left optical axis, mm.
        assumed: noise, and what is known of the images.
    """
    from rigsim.study.calc import sight
    from rigsim.theory.uncertainty import predict_depth_bias

    noise, sized = assumed.noise, assumed.sized
    on_axis = np.array([0.0, 0.0, depth_mm / 1e3])
    uv_left, uv_right = rig.project(on_axis[None])
    seen = sight.sight_of_point(rig, on_axis, sized=sized)
    depth = about(rig, on_axis, noise, assumed.disparity_error_px, seen.by_both)
    bias_mm = float(predict_depth_bias(rig, on_axis[None], noise)[0]) * 1e3
    disparity_px = float(uv_left[0, 0] - uv_right[0, 0])
    both = seen.by_both
    facts = (
        Fact("seen_by", "seen by", seen.seen_by, "", whose(sized, "which cameras see the point")),
        Fact("z", "Z", depth_mm, "mm", "depth, on the left optical axis", depth.errors_mm[2]),
        Fact("focal_px", "focal length", rig.left.fx, "px", "of the left camera"),
        Fact("disparity_px", "disparity", if_seen(both, disparity_px), "px", "u left - u right"),
        *row_facts(rig, depth_mm / 1e3, sized=sized, seen=both),
        *depth.facts,
        Fact(
            "depth_bias", "depth bias", if_seen(both, bias_mm), "mm", "mean error of many noisy measurements"
        ),
    )
    return DepthAnswer(
        facts, (*assumed.odd, *sight.rig_remarks(rig, sized=sized), *seen.remarks, *depth.remarks)
    )
