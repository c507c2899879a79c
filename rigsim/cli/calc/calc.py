"""`rigsim calc`: closed forms for one point, one distance or one rig; nothing is rendered."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rigsim.api.calc.fact import Assumed, Fact, values
from rigsim.api.calc.rows import for_people
from rigsim.cli.calc.beside import At, print_beside, row_of
from rigsim.cli.calc.limits import limits
from rigsim.cli.calc.motion import motion
from rigsim.cli.calc.points import points
from rigsim.cli.kit.answer import print_remarks
from rigsim.cli.kit.facts import Form, print_facts
from rigsim.cli.kit.golden import GoldenWords
from rigsim.cli.kit.options import (
    Csv,
    DisparityNoise,
    Json,
    Markdown,
    Noise,
    Principal,
    takes,
    takes_rig,
)
from rigsim.typed import quantity
from rigsim.typed.noise import pixel_noise
from rigsim.typed.rigs import RigOptions, single_rig

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

    from rigsim.api.calc.point import calc_point

    error = words.disparity_error
    assumed = Assumed(
        noise,
        sized=options.has_size,
        from_axis=not (options.has_size or words.principal),
        disparity_error_px=None if error is None else quantity.value(error, _ERROR),
        odd=tuple(options.mode_remarks(rig)),
    )
    answer = calc_point(rig, uv_left, uv_right, assumed)
    if words.plot is not None:
        _draw(words.plot, rig, answer.point_left[None], noise)
    print_remarks(answer.remarks)
    print_facts(answer.facts, title="Point", form=form, document=answer.document, golden=golden)


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
    from rigsim.api.calc.depth import calc_depth
    from rigsim.rig.remark import Remark

    error = words.disparity_error
    assumed = Assumed(
        noise,
        sized=options.has_size,
        disparity_error_px=None if error is None else quantity.value(error, _ERROR),
        odd=tuple(options.mode_remarks(rig)),
    )
    told = calc_depth(rig, depth_mm, assumed)
    remarks = list(told.remarks)
    if not (values(told.facts)["seen_by"] == "both" or quantity.UNIT.search(words.z)):
        says = f"depth {words.z} was taken in mm: write {words.z}m if metres are meant"
        remarks.append(Remark("unit", says))
    return list(told.facts), remarks


app.command()(points)
app.command()(limits)
app.command()(motion)


def _draw(path: Path, rig: StereoRig, point_left: Array, noise: PixelNoise) -> None:
    from rigsim.interop.files.folder import write_file
    from rigsim.present.kit.style import to_png
    from rigsim.present.kit.topdown import topdown_figure

    figure = topdown_figure(rig, point_left, noise=noise, rays=True)
    write_file(path, to_png(figure))
