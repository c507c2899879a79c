"""`rigsim calc`: closed forms for one point, one distance or one rig; nothing is rendered."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from rigsim.cli.calc.beside import At, print_beside, row_of
from rigsim.cli.calc.limits import limits
from rigsim.cli.calc.motion import motion
from rigsim.cli.calc.points import points
from rigsim.cli.calc.rows import for_people, row_facts
from rigsim.cli.kit import quantity
from rigsim.cli.kit.answer import print_remarks
from rigsim.cli.kit.facts import Fact, Form, print_facts, values
from rigsim.cli.kit.golden import GoldenWords
from rigsim.cli.kit.options import (
    Csv,
    DisparityNoise,
    Json,
    Markdown,
    Noise,
    Principal,
    pixel_noise,
    single_rig,
    takes,
    takes_rig,
)
from rigsim.cli.kit.rigs import RigOptions
from rigsim.errors import RigsimError

if TYPE_CHECKING:
    from rigsim.rig.arrays import Array
    from rigsim.rig.noise import PixelNoise
    from rigsim.rig.remark import Remark
    from rigsim.rig.stereo import StereoRig

app = typer.Typer(name="calc", help="Calculate with closed forms: a point, a distance, a rig's limits.")

DisparityError = Annotated[
    str | None,
    typer.Option(
        metavar="PX", help="Disparity error of the bounds; the noise's standard deviation by default."
    ),
]
_ERROR = quantity.QuantityKind("disparity error", "px", quantity.NOISE.factors, at_least=0)


@app.callback(invoke_without_command=True)
def _calc(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@dataclass(frozen=True, slots=True)
class PointWords:
    """The options of `rigsim calc point`, as typed."""

    left: Annotated[str, typer.Option(metavar="U,V", help="The point in the left image, px: 980,500.")]
    right: Annotated[str, typer.Option(metavar="U,V", help="The point in the right image, px: 910,500.")]
    principal: Principal = None
    noise: Noise = None
    disparity_noise: DisparityNoise = None
    disparity_error: DisparityError = None
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the rig and the point from above, as PNG.")
    ] = None
    as_json: Json = False
    as_csv: Csv = False
    as_markdown: Markdown = False


@app.command()
@takes_rig
@takes(PointWords)
@takes(GoldenWords)
def point(options: RigOptions, words: PointWords, golden: GoldenWords) -> None:
    """Triangulate one point seen in both images, with its uncertainty.

    Lengths are in mm, in the left camera's frame: X right, Y down, Z forward. Without --resolution pixels,
    and so X and Y, count from the optical axis.
    """
    form = Form(words.as_json, words.as_csv, words.as_markdown)
    golden.check("calc point")
    rig = single_rig(options, words.principal, size_for="--plot" if words.plot else "")
    noise = pixel_noise(words.noise, words.disparity_noise)
    uv_left = quantity.point(words.left, "left position")
    uv_right = quantity.point(words.right, "right position")

    import numpy as np

    from rigsim.study.calc import sight
    from rigsim.theory.triangulation import triangulate

    found = triangulate(rig, [uv_left], [uv_right])[0]
    if not found[2] > 0:
        raise RigsimError(_why_no_depth(rig, uv_left[0] - uv_right[0]))
    uv = np.array(uv_left), np.array(uv_right)
    seen = sight.sight_of_pixels(rig, *uv, sized=options.has_size)
    residual = sight.residual_px(rig, found, *uv)
    about = _about(rig, found, noise, words.disparity_error, seen.by_both)
    remarks = [
        *options.mode_remarks(rig),
        *sight.rig_remarks(rig, sized=options.has_size),
        *seen.remarks,
        *sight.residual_remarks(rig, residual, noise, *uv),
        *about.remarks,
    ]
    from_axis = not (options.has_size or words.principal)
    frame_x, frame_y = ("'s axis, where u = 0", "'s axis, where v = 0") if from_axis else ("", "")
    x, y, z = (float(value) * 1e3 for value in found)
    error_x, error_y, error_z = about.errors_mm
    facts = [
        Fact("seen_by", "seen by", seen.seen_by, "", _whose(options, "whose image holds its pixel")),
        Fact("x", "X", x, "mm", f"right of the left camera{frame_x}", error_x),
        Fact("y", "Y", y, "mm", f"below the left camera{frame_y}", error_y),
        Fact("z", "Z", z, "mm", "depth, in front of the left camera", error_z),
        Fact("disparity_px", "disparity", uv_left[0] - uv_right[0], "px", "u left - u right"),
        *_residual_facts(residual, noise),
        *about.facts,
    ]
    if words.plot is not None:
        _draw(words.plot, rig, found[None], noise)
    origin = "optical axis" if from_axis else "first pixel"

    def document() -> dict[str, Any]:
        from rigsim.interop.documents.calc import point_document

        return point_document(values(facts), origin, remarks)

    print_remarks(remarks)
    print_facts(facts, title="Point", form=form, document=document, golden=golden)


@dataclass(frozen=True, slots=True)
class DepthWords:
    """The options of `rigsim calc depth`, as typed."""

    z: Annotated[
        str,
        typer.Option(
            "--z", metavar="LENGTHS", help="Distances Z along the left optical axis: 3m, or 1,3,6m."
        ),
    ]
    noise: Noise = None
    disparity_noise: DisparityNoise = None
    disparity_error: DisparityError = None
    as_json: Json = False
    as_csv: Csv = False
    as_markdown: Markdown = False


@app.command()
@takes_rig
@takes(DepthWords)
@takes(GoldenWords)
def depth(options: RigOptions, words: DepthWords, golden: GoldenWords) -> None:
    """Predict the depth error at a distance, on the left camera's optical axis.

    --preset a,b or --rig a.toml,b.toml, and several distances, make one table, beside what the makers claim.
    """
    form = Form(words.as_json, words.as_csv, words.as_markdown)
    golden.check("calc depth")
    rigs = [(name, one, single_rig(one, None)) for name, one in options.each()]
    noise = pixel_noise(words.noise, words.disparity_noise)
    depths_mm = quantity.distances(words.z)
    at = [
        At(name, depth_mm, rig, one.preset, *_depth_at(one, rig, depth_mm, words, noise))
        for name, one, rig in rigs
        for depth_mm in depths_mm
    ]
    if len(at) > 1:
        print_beside(at, noise.std_px, form, golden)
        return
    facts, remarks = at[0].facts, at[0].remarks

    def document() -> dict[str, Any]:
        from rigsim.interop.documents.calc import depth_document

        return depth_document(values(facts), remarks, [row_of(at[0])])

    print_remarks(remarks)
    shown = for_people(facts, at[0].rig)
    print_facts(shown, title="Depth", form=form, document=document, rows=[facts], golden=golden)


def _depth_at(
    options: RigOptions,
    rig: StereoRig,
    depth_mm: float,
    words: DepthWords,
    noise: PixelNoise,
) -> tuple[list[Fact], list[Remark]]:
    """What is told of one rig at one distance, and what is odd about it."""
    import numpy as np

    from rigsim.rig.remark import Remark
    from rigsim.study.calc import sight
    from rigsim.theory.uncertainty import predict_depth_bias

    on_axis = np.array([0.0, 0.0, depth_mm / 1e3])
    uv_left, uv_right = rig.project(on_axis[None])
    seen = sight.sight_of_point(rig, on_axis, sized=options.has_size)
    about = _about(rig, on_axis, noise, words.disparity_error, seen.by_both)
    bias_mm = float(predict_depth_bias(rig, on_axis[None], noise)[0]) * 1e3
    disparity_px = float(uv_left[0, 0] - uv_right[0, 0])
    facts = [
        Fact("seen_by", "seen by", seen.seen_by, "", _whose(options, "which cameras see the point")),
        Fact("z", "Z", depth_mm, "mm", "depth, on the left optical axis", about.errors_mm[2]),
        Fact("focal_px", "focal length", rig.left.fx, "px", "of the left camera"),
        Fact("disparity_px", "disparity", _if(seen.by_both, disparity_px), "px", "u left - u right"),
        *row_facts(rig, depth_mm / 1e3, sized=options.has_size, seen=seen.by_both),
        *about.facts,
        Fact(
            "depth_bias",
            "depth bias",
            _if(seen.by_both, bias_mm),
            "mm",
            "mean error of many noisy measurements",
        ),
    ]
    remarks = [
        *options.mode_remarks(rig),
        *sight.rig_remarks(rig, sized=options.has_size),
        *seen.remarks,
        *about.remarks,
    ]
    if not (seen.by_both or quantity.UNIT.search(words.z)):
        says = f"depth {words.z} was taken in mm: write {words.z}m if metres are meant"
        remarks.append(Remark("unit", says))
    return facts, remarks


app.command()(points)
app.command()(limits)
app.command()(motion)


class _About(NamedTuple):
    """What is known about one point's depth."""

    facts: list[Fact]
    errors_mm: tuple[float, float, float]
    remarks: list[Remark]


def _about(
    rig: StereoRig, point_left: Array, noise: PixelNoise, disparity_error: str | None, seen: bool
) -> _About:
    """Errors of a point (3,) m; NaN unless both cameras see it."""
    import numpy as np

    from rigsim.study.calc.sight import noise_remarks
    from rigsim.theory.limits import world_per_pixel_m
    from rigsim.theory.uncertainty import depth_bounds, predict_covariance

    at = point_left[None]
    error_px = noise.disparity_std_px
    if disparity_error is not None:
        error_px = quantity.value(disparity_error, _ERROR)
    per_pixel_mm = float(world_per_pixel_m(rig, point_left[2])) * 1e3
    stds = near = far = math.nan
    errors_mm = (math.nan, math.nan, math.nan)
    if seen:
        near, far = (float(bound[0]) * 1e3 for bound in depth_bounds(rig, at, error_px))
        x, y, std_mm = (
            float(value) for value in np.sqrt(np.diag(predict_covariance(rig, at, noise)[0])) * 1e3
        )
        stds = std_mm
        gap = point_left[2] * 1e3 - near
        errors_mm = (x, y, min((size for size in (std_mm, gap) if size > 0), default=math.nan))
    off = f"when the disparity is off by {error_px:.4g} px"
    if not rig.is_rectified:
        off = f"when both pixels are off by {error_px / math.sqrt(2):.4g} px in all"
    facts = [
        Fact("world_per_pixel", "width of a pixel", per_pixel_mm, "mm", "at this depth"),
        Fact("depth_std", "depth std", stds, "mm", f"for {noise.std_px:g} px of noise per coordinate", stds),
        Fact("depth_near", "nearest depth", near, "mm", off, errors_mm[2]),
        Fact("depth_far", "farthest depth", far, "mm", off, errors_mm[2]),
    ]
    return _About(facts, errors_mm, list(noise_remarks(rig, point_left, noise)) if seen else [])


def _residual_facts(residual: float, noise: PixelNoise) -> list[Fact]:
    # under a billionth of a pixel there is nothing but rounding
    residual = residual if residual > 1e-9 else 0.0
    sigmas = residual / noise.std_px if noise.std_px else math.nan if residual else 0.0
    return [
        Fact("residual_px", "residual", residual, "px", "reprojection error of the pixel pair"),
        Fact("residual_sigma", "residual / noise", sigmas, "", "over 3 is unusual for a matching pair"),
    ]


def _if(told: bool, value: float) -> float:
    return value if told else math.nan


def _whose(options: RigOptions, says: str) -> str:
    return says if options.has_size else "no --resolution: images without an edge"


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
    from rigsim.interop.files.folder import write_file
    from rigsim.present.kit.style import to_png
    from rigsim.present.kit.topdown import topdown_figure

    figure = topdown_figure(rig, point_left, noise=noise, rays=True)
    write_file(path, to_png(figure))
