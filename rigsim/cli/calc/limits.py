"""`rigsim calc limits`: what a rig can see at all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rigsim.api.calc.fact import values
from rigsim.api.calc.limits import Reached, Search, facts_at, rig_facts, search_facts
from rigsim.api.calc.rows import for_people
from rigsim.cli.kit.answer import print_remarks
from rigsim.cli.kit.facts import Form, print_facts
from rigsim.cli.kit.golden import GoldenWords
from rigsim.cli.kit.options import Csv, Json, Markdown, Principal, takes, takes_rig
from rigsim.errors import InvalidRange
from rigsim.typed import quantity
from rigsim.typed.rigs import RigOptions, single_rig
from rigsim.typed.search import searched

if TYPE_CHECKING:
    from rigsim.rig.remark import Remark
    from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True, slots=True)
class LimitsWords:
    """The options of `rigsim calc limits`, as typed."""

    z: Annotated[
        str,
        typer.Option(
            "--z",
            metavar="LENGTHS",
            help="Distances Z along the left optical axis at which overlap and depth step are given: 1,3m.",
        ),
    ] = "1m"
    disparities: Annotated[
        str | None,
        typer.Option(
            metavar="MIN:MAX",
            help="Disparities a matcher searches, px; by default what is published of the preset, or 1:128.",
        ),
    ] = None
    shift: Annotated[
        str | None, typer.Option(metavar="PX", help="Disparity shift added to the search; 0 by default.")
    ] = None
    reach: Annotated[
        str | None,
        typer.Option(
            metavar="NEAR[:FAR]",
            help="Find the disparity shift with which the search reaches this near, and as far as FAR.",
        ),
    ] = None
    principal: Principal = None
    as_json: Json = False
    as_csv: Csv = False
    as_markdown: Markdown = False


@takes_rig
@takes(LimitsWords)
@takes(GoldenWords)
def limits(options: RigOptions, words: LimitsWords, golden: GoldenWords) -> None:
    """Say what a rig can see: depth range, overlap, blind zone, depth step.

    Every Z counts along the left camera's optical axis.
    """
    form = Form(words.as_json, words.as_csv, words.as_markdown)
    golden.check("calc limits")
    rig = single_rig(options, words.principal, size_for="calc limits")
    depths_mm = quantity.distances(words.z)
    shift, reach = words.shift, words.reach
    if shift is not None and reach is not None:
        raise InvalidRange("--shift and --reach both given: --reach finds the shift, give one")
    search = searched(options, words.disparities)
    shift_px = quantity.value(shift, quantity.DISPARITY) if shift is not None else 0.0
    reached = _reach(rig, search, reach) if reach is not None else Reached(shift_px, "added to both", ())

    _tell(rig, depths_mm, search, reached, form, golden, options.mode_remarks(rig))


def _tell(
    rig: StereoRig,
    depths_mm: Sequence[float],
    search: Search,
    reached: Reached,
    form: Form,
    golden: GoldenWords,
    odd: Sequence[Remark],
) -> None:
    from rigsim.study.calc.limits import limit_remarks
    from rigsim.study.calc.sight import rig_remarks

    ahead = [*rig_facts(rig), *search_facts(rig, search, reached)]
    at = [facts_at(rig, depth_mm) for depth_mm in depths_mm]
    remarks = [
        *odd,
        *rig_remarks(rig, sized=True),
        *reached.remarks,
        *limit_remarks(rig, [depth_mm / 1e3 for depth_mm in depths_mm]),
    ]

    def document() -> dict[str, Any]:
        from rigsim.interop.documents.calc import limits_document

        return limits_document(values(ahead), [values(facts) for facts in at], remarks)

    print_remarks(remarks)
    print_facts(
        [*ahead, *(fact for facts in at for fact in for_people(facts, rig))],
        title="Limits",
        form=form,
        document=document,
        rows=[[*ahead, *facts] for facts in at],
        golden=golden,
    )


def _reach(rig: StereoRig, search: Search, reach: str) -> Reached:
    """The least shift, in whole pixels, with which the search reaches the range asked for."""
    from rigsim.study.calc.limits import shift_for

    near_mm, far_mm = quantity.distances(reach)[0], None
    if ":" in reach:
        near_mm, far_mm = quantity.span(reach, quantity.DEPTH)
    found = shift_for(
        rig, near_mm / 1e3, None if far_mm is None else far_mm / 1e3, search.high_px, search.low_px
    )
    wanted = f"{near_mm:g} mm" + (f" to {far_mm:g} mm" if far_mm else "")
    return Reached(found.shift_px, f"added to both, to reach {wanted}", found.remarks)
