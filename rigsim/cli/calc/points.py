"""`rigsim calc points`: a CSV of matched pixels to points, each with its uncertainty."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli.kit.answer import print_document, print_remarks
from rigsim.cli.kit.facts import Form
from rigsim.cli.kit.golden import GoldenWords, held, leave_where_moved, print_report
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
from rigsim.errors import OutputError
from rigsim.typed.noise import pixel_noise
from rigsim.typed.rigs import RigOptions, single_rig

if TYPE_CHECKING:
    from rigsim.api.triangulate_points import TriangulatedPairs
    from rigsim.rig.stereo import StereoRig

Pairs = Annotated[
    Path,
    typer.Argument(
        metavar="PAIRS.csv",
        help="Table of matched pixels: columns u_left, v_left, u_right, v_right, px, and any others.",
        show_default=False,
    ),
]


@dataclass(frozen=True, slots=True)
class PointsWords:
    """The options of `rigsim calc points`, as typed."""

    principal: Principal = None
    noise: Noise = None
    disparity_noise: DisparityNoise = None
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the table with its points, as CSV.")
    ] = None
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False
    as_json: Json = False
    as_csv: Csv = False
    as_markdown: Markdown = False


@takes_rig
@takes(PointsWords)
@takes(GoldenWords)
def points(options: RigOptions, pairs: Pairs, words: PointsWords, golden: GoldenWords) -> None:
    """Triangulate a CSV of matched pixels, with the uncertainty of each point, and check that they match.

    Added are x_mm, y_mm, z_mm in the left camera's frame (X right, Y down, Z forward), std_x_mm, std_y_mm,
    std_z_mm, off_px (how far the two pixels are from each other's epipolar lines), consistent (no further
    than the noise explains; right pairs are called otherwise once in 1000) and why there is no point.
    """
    form = Form(words.as_json, words.as_csv, words.as_markdown)
    golden.check("calc points")
    if words.out is not None and words.out.exists() and not words.force:
        raise OutputError(
            f"output file {words.out}: is there; choose another one, or add --force to replace it"
        )
    rig = single_rig(options, words.principal)
    result = held(_found(options, rig, pairs, words), golden, "calc points")
    print_remarks(result.remarks)
    if words.out is not None:
        from rigsim.interop.files.folder import write_file

        write_file(words.out, result.csv.encode())
    _print(result, form, words.out)
    leave_where_moved(result.golden)


def _found(options: RigOptions, rig: StereoRig, pairs: Path, words: PointsWords) -> TriangulatedPairs:
    from rigsim.api.triangulate_points import TriangulatedPairs
    from rigsim.interop.files.pixels import read_pairs
    from rigsim.study.calc.points import pair_points, pair_remarks
    from rigsim.study.calc.sight import rig_remarks

    table = read_pairs(pairs)
    found = pair_points(rig, table.uv, pixel_noise(words.noise, words.disparity_noise))
    sized = options.has_size
    from_axis = not (sized or words.principal)
    remarks = [
        *options.mode_remarks(rig),
        *rig_remarks(rig, sized=sized),
        *pair_remarks(found, sized=sized),
    ]
    return TriangulatedPairs(found, table, tuple(remarks), "optical axis" if from_axis else "first pixel")


def _print(result: TriangulatedPairs, form: Form, out: Path | None) -> None:
    if form.json:
        print_document(result.document())
        return
    if form.csv:
        typer.echo(result.csv, nl=False)
    else:
        from rigsim.present.kit.points import print_points

        print_points(result.found, markdown=form.markdown, file=out)
    if result.golden is not None:
        print_report(result.golden, stderr=form.csv or form.markdown)
