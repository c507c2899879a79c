"""`rigsim calc`: closed forms for one point, one distance or one rig; nothing is rendered."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli import quantity
from rigsim.cli.facts import Fact, print_facts
from rigsim.cli.options import Csv, Json, Markdown, Noise, Principal, single_rig, takes_rig
from rigsim.cli.rigs import RigOptions
from rigsim.errors import RigsimError

if TYPE_CHECKING:
    from rigsim.rig.arrays import Array
    from rigsim.rig.noise import PixelNoise
    from rigsim.rig.stereo import StereoRig

app = typer.Typer(name="calc", help="Calculate with closed forms: a point, a distance, a rig's limits.")

DisparityError = Annotated[
    str | None,
    typer.Option(
        metavar="PX", help="Disparity error of the bounds; the noise's standard deviation by default."
    ),
]
_TRUSTED = 4
"""Disparities under this many times their noise are outside what std and bias describe."""
_ERROR = quantity.Kind("disparity error", "px", quantity.NOISE.factors, at_least=0)


@app.callback(invoke_without_command=True)
def _calc(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command()
@takes_rig
def point(
    options: RigOptions,
    left: Annotated[str, typer.Option(metavar="U,V", help="The point in the left image, px: 980,500.")],
    right: Annotated[str, typer.Option(metavar="U,V", help="The point in the right image, px: 910,500.")],
    principal: Principal = None,
    noise: Noise = "0.25",
    disparity_error: DisparityError = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the rig and the point from above, as PNG.")
    ] = None,
    as_json: Json = False,
    as_csv: Csv = False,
    as_markdown: Markdown = False,
) -> None:
    """Triangulate one point seen in both images, with its uncertainty.

    Lengths are in mm, in the left camera's frame: X right, Y down, Z forward.
    """
    rig = single_rig(options, principal, size_for="--plot" if plot else "")
    pixel_noise = _noise(noise)
    uv_left, uv_right = quantity.point(left, "left position"), quantity.point(right, "right position")

    from rigsim.theory.triangulation import triangulate

    point_left = triangulate(rig, [uv_left], [uv_right])
    disparity_px = uv_left[0] - uv_right[0]
    x, y, z = (float(value) * 1e3 for value in point_left[0])
    if not z > 0:
        raise RigsimError(_why_no_depth(rig, disparity_px))
    facts = [
        Fact("x", "X", x, "mm", "right of the left camera"),
        Fact("y", "Y", y, "mm", "below the left camera"),
        Fact("z", "Z", z, "mm", "depth, in front of the left camera"),
        Fact("disparity_px", "disparity", disparity_px, "px", "u left - u right"),
        *_depth_facts(rig, point_left, pixel_noise, disparity_error),
    ]
    if plot is not None:
        _draw(plot, rig, point_left, pixel_noise)
    print_facts(facts, title="Point", as_json=as_json, as_csv=as_csv, as_markdown=as_markdown)


@app.command()
@takes_rig
def depth(
    options: RigOptions,
    z: Annotated[
        str, typer.Option("--z", metavar="LENGTH", help="Distance along the left optical axis: 3m.")
    ],
    noise: Noise = "0.25",
    disparity_error: DisparityError = None,
    as_json: Json = False,
    as_csv: Csv = False,
    as_markdown: Markdown = False,
) -> None:
    """Predict the depth error at a distance."""
    rig = single_rig(options, None)
    pixel_noise = _noise(noise)
    depth_mm = quantity.value(z, quantity.DEPTH)

    import numpy as np

    from rigsim.theory.uncertainty import predict_depth_bias

    point_left = np.array([[0.0, 0.0, depth_mm / 1e3]])
    uv_left, uv_right = rig.project(point_left)
    bias_mm = float(predict_depth_bias(rig, point_left, pixel_noise)[0]) * 1e3
    facts = [
        Fact("z", "Z", depth_mm, "mm", "depth on the left optical axis"),
        Fact("focal_px", "focal length", rig.left.fx, "px", "of the left camera"),
        Fact("disparity_px", "disparity", float(uv_left[0, 0] - uv_right[0, 0]), "px", "u left - u right"),
        *_depth_facts(rig, point_left, pixel_noise, disparity_error),
        Fact("depth_bias", "depth bias", bias_mm, "mm", "mean error of many noisy measurements"),
    ]
    print_facts(facts, title="Depth", as_json=as_json, as_csv=as_csv, as_markdown=as_markdown)


@app.command()
@takes_rig
def limits(
    options: RigOptions,
    z: Annotated[
        str, typer.Option("--z", metavar="LENGTH", help="Distance at which overlap and depth step are told.")
    ] = "1m",
    disparities: Annotated[
        str, typer.Option(metavar="MIN:MAX", help="Disparities a matcher searches, px.")
    ] = "1:128",
    shift: Annotated[str, typer.Option(metavar="PX", help="Disparity shift added to the search.")] = "0",
    principal: Principal = None,
    as_json: Json = False,
    as_csv: Csv = False,
    as_markdown: Markdown = False,
) -> None:
    """Tell what a rig can see at all: depth range, overlap, blind zone, depth step."""
    rig = single_rig(options, principal, size_for="calc limits")
    depth_mm = quantity.value(z, quantity.DEPTH)
    low_px, high_px = quantity.span(disparities, quantity.DISPARITY)
    shift_px = quantity.value(shift, quantity.DISPARITY)

    from rigsim.theory import limits as theory

    nearest = farthest = math.nan
    if rig.is_rectified:
        nearest, farthest = theory.depth_range_for_disparities(rig, high_px, low_px, shift_px=shift_px)
    depth_m = depth_mm / 1e3
    overlap = theory.overlap_at_depth(rig, depth_m)
    band_px = float(theory.dead_band_px(rig, depth_m))
    band_mm = band_px * float(theory.world_per_pixel_m(rig, depth_m)) * 1e3
    search = (
        f"{low_px + shift_px:g} to {high_px + shift_px:g} px" if rig.is_rectified else "needs a rectified rig"
    )
    at = f"at Z = {depth_mm:g} mm"
    facts = [
        Fact("focal_px", "focal length", rig.left.fx, "px", "of the left camera"),
        Fact("hfov_deg", "field of view", rig.left.hfov_deg, "deg", "horizontal, of the left camera"),
        Fact("min_depth", "min depth", nearest * 1e3, "mm", f"largest disparity searched ({search})"),
        Fact("max_depth", "max depth", farthest * 1e3, "mm", f"smallest disparity searched ({search})"),
        Fact(
            "overlap_fov_deg", "overlap", theory.overlap_fov_deg(rig), "deg", "seen by both cameras far away"
        ),
        Fact(
            "blind_zone",
            "blind zone",
            theory.blind_zone_m(rig) * 1e3,
            "mm",
            "nearer, no point is seen by both",
        ),
        Fact("overlap_width", "overlap width", float(overlap.width_m) * 1e3, "mm", f"seen by both {at}"),
        Fact("overlap_fraction", "overlap share", float(overlap.fraction), "", f"of the left image {at}"),
        Fact("dead_band_px", "dead band", band_px, "px", f"left image columns unseen by the right {at}"),
        Fact("dead_band", "dead band width", band_mm, "mm", f"the same in the scene {at}"),
        Fact(
            "depth_step",
            "depth step",
            float(theory.depth_step_m(rig, depth_m)) * 1e3,
            "mm",
            f"of one pixel of disparity {at}",
        ),
    ]
    print_facts(facts, title="Limits", as_json=as_json, as_csv=as_csv, as_markdown=as_markdown)


def _noise(text: str) -> PixelNoise:
    from rigsim.rig.noise import PixelNoise

    return PixelNoise(quantity.value(text, quantity.NOISE))


def _depth_facts(
    rig: StereoRig, point_left: Array, noise: PixelNoise, disparity_error: str | None
) -> list[Fact]:
    """What is known about the depth of one point (1, 3) m."""
    from rigsim.theory.limits import world_per_pixel_m
    from rigsim.theory.uncertainty import depth_bounds, parallax_px, predict_depth_std

    trusted_px, parallax = _TRUSTED * noise.disparity_std_px, float(parallax_px(rig, point_left)[0])
    if parallax < trusted_px:
        typer.echo(
            f"rigsim: note: disparity {parallax:.3g} px is under {trusted_px:.3g} px, {_TRUSTED} times its"
            " noise: trust the bounds, not the std",
            err=True,
        )

    error_px = noise.disparity_std_px
    if disparity_error is not None:
        error_px = quantity.value(disparity_error, _ERROR)
    near, far = (float(bound[0]) * 1e3 for bound in depth_bounds(rig, point_left, error_px))
    std_mm = float(predict_depth_std(rig, point_left, noise)[0]) * 1e3
    per_pixel_mm = float(world_per_pixel_m(rig, point_left[0, 2])) * 1e3
    off = f"when the disparity is off by {error_px:.4g} px"
    return [
        Fact("world_per_pixel", "width of a pixel", per_pixel_mm, "mm", "at this depth"),
        Fact("depth_std", "depth std", std_mm, "mm", f"for {noise.std_px:g} px of noise per coordinate"),
        Fact("depth_near", "nearest depth", near, "mm", off),
        Fact("depth_far", "farthest depth", far, "mm", off),
    ]


def _why_no_depth(rig: StereoRig, disparity_px: float) -> str:
    """What to say of two pixels whose rays meet nowhere in front of the rig."""
    offset = f" (+ {rig.doffs_px:g} px doffs)" if rig.doffs_px else ""
    says = f"disparity {disparity_px:g} px{offset}: "
    if not rig.is_rectified:
        return (
            says
            + "the rays do not meet in front of both cameras; left and right swapped, or a calibration error"
        )
    if disparity_px + rig.doffs_px == 0:
        return says + "must be > 0; the point is at infinity, or a calibration error hides its parallax"
    return says + "must be > 0; left and right swapped, or a calibration error (principal points, rotation)"


def _draw(path: Path, rig: StereoRig, point_left: Array, noise: PixelNoise) -> None:
    from rigsim.interop.folder import write_file
    from rigsim.present.style import to_png
    from rigsim.present.topdown import topdown_figure

    figure = topdown_figure(rig, point_left, noise=noise, rays=True, error_name="predicted depth std")
    write_file(path, to_png(figure))
