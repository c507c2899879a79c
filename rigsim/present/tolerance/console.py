"""A tolerance study for people: the table in a terminal, and one picture."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rigsim.present.kit.console import make_console, paragraph, print_table
from rigsim.present.kit.format import MISSING, number, percent, plain
from rigsim.present.tolerance.words import (
    calibration_sentence,
    hopeless_sentence,
    informed_sentence,
    interactions_sentence,
    motion_sentence,
    recalibration_sentence,
    rows_sentence,
    yield_sentence,
)
from rigsim.study.tolerance import columns as col
from rigsim.study.tolerance.built import percentile_mm
from rigsim.study.tolerance.run import ToleranceResult
from rigsim.study.tolerance.sensitivities import QUANTITIES, UNITS, Sensitivity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_HEIGHT_IN = 3.6


def print_tolerance(result: ToleranceResult, folder: Path | None = None) -> None:
    """Print the ranked table, the built rigs at each depth, and how many meet the requirement."""
    row_px = result.required.row_px
    hopeless = hopeless_sentence(result)
    if hopeless:
        paragraph(make_console(), hopeless)
    print_table(
        f"Each quantity alone: depth error, mm, first order; what it takes for 95 of 100 rigs to stay within"
        f" {plain(result.required.error_m * 1e3)} mm at {plain(result.required.depth_m)} m"
        + (" with their noise" if result.noise_px else "")
        + (f", and their rows within {plain(row_px)} px" if row_px is not None else ""),
        quantity_heads(result),
        quantity_rows(result),
        numeric=quantity_numeric(result),
    )
    at = f"{plain(result.required.depth_m)} m"
    print_table(
        f"Row misalignment each makes, px, shares of the variance at {at}, %, and where tolerances come from",
        (_head(col.QUANTITY), *row_heads(result), *variance_heads()[1:]),
        [
            (row[0], *rows, *row[1:])
            for row, rows in zip(variance_rows(result), row_rows(result), strict=True)
        ],
        numeric=(False, True, True, True, True, True, True, False),
    )
    _print_built(result)
    _print_rows(result)
    console = make_console()
    for sentence in (
        yield_sentence(result),
        informed_sentence(result),
        rows_sentence(result),
        interactions_sentence(result),
        calibration_sentence(result),
        motion_sentence(result),
        recalibration_sentence(result),
    ):
        if sentence:
            paragraph(console, sentence)
    if folder is not None:
        console.print(f"Files: {folder}", soft_wrap=True)


def _print_built(result: ToleranceResult) -> None:
    how = "built within tolerance" if result.tolerances.calibration is None else "so calibrated"
    print_table(
        f"{result.n_rigs} rigs {how}: depth error over the image, mm; rigs with pixel noise",
        (
            "distance\nm",
            "noise\nalone",
            "build, first\norder",
            "simu-\nlated",
            "median\nrig",
            "95th\npercentile",
            "median re-\ncalibrated",
            "95th\npercentile",
            "first order",
        ),
        [
            (
                plain(item.depth_m),
                number(item.noise_mm) if item.noise_mm else "0",
                number(item.first_order_mm),
                number(item.rms_mm),
                *(
                    MISSING if rigs is None else number(percentile_mm(rigs.whole_mm, level))
                    for rigs in (item.built, item.recalibrated)
                    for level in (50, 95)
                ),
                "flagged: do not trust" if item.parts else "holds",
            )
            for item in result.depths
        ],
        numeric=(*[True] * 8, False),
    )


def _head(name: str, unit: bool = True) -> str:
    column = col.COLUMNS[name]
    # depth errors are in mm, as the table's title says
    percent_sign = column.shown_unit == "%" and unit
    return f"{column.heading}\n%" if percent_sign else column.heading


def headline(result: ToleranceResult) -> str:
    """The answer in one sentence."""
    return yield_sentence(result)


def quantity_heads(result: ToleranceResult) -> tuple[str, ...]:
    """Heads of the ranked table; a newline starts a second line."""
    judged = f"{plain(result.required.depth_m)} m"
    return (
        _head(col.QUANTITY),
        _head(col.TOLERANCE),
        *(f"at\n{plain(item.depth_m)} m" for item in result.depths),
        f"{_head(col.COMMON)}\nat {judged}",
        _head(col.DIFFERING),
        _head(col.VARIANCE_SHARE),
        _head(col.NEEDED_ALONE),
        *(["held\nby"] if _has_rows(result) else []),
        _head(col.NEEDED_EQUAL_SHARE),
        _head(col.UNIT),
    )


def quantity_rows(result: ToleranceResult) -> list[tuple[str, ...]]:
    """Rows of the ranked table, the worst quantity first; depth errors in mm."""
    return [
        (
            result.tolerances.title(item.key),
            _tolerance(result, item.key, item.tolerance),
            *(number(value) for value in item.depth_rms_mm),
            number(item.common_mm),
            number(item.differing_mm),
            percent(item.share) if item.share > 1e-12 else "0",
            _tolerance(result, item.key, item.needed_alone),
            *([_held_by(item)] if _has_rows(result) else []),
            _tolerance(result, item.key, item.needed_equal_share),
            UNITS[item.key],
        )
        for item in result.sensitivities
    ]


def quantity_numeric(result: ToleranceResult) -> tuple[bool, ...]:
    """Which of the ranked table's columns stand right."""
    before = [True] * (5 + len(result.depths))
    return (False, *before, *([False] if _has_rows(result) else []), True, False)


def _has_rows(result: ToleranceResult) -> bool:
    """Whether the rows are held to a bound beside the depth."""
    return result.required.row_px is not None


def _held_by(item: Sensitivity) -> str:
    """Which of the two bounds the tolerance needed alone keeps."""
    if not 0 < item.needed_alone < math.inf:
        return ""
    return "rows" if item.is_held_by_rows else "depth"


def row_heads(result: ToleranceResult) -> tuple[str, str]:
    """Heads of what each quantity does to the rows."""
    near, far = result.depths[0].depth_m, result.depths[-1].depth_m
    at = f"{plain(result.required.depth_m)} m"
    return f"{_head(col.ROW)}\nat {at}", f"{_head(col.ROW_LARGEST)}\n{plain(near)} to {plain(far)} m"


def row_rows(result: ToleranceResult) -> list[tuple[str, str]]:
    """Row misalignment of each quantity, px, at the judged distance and at most; the worst quantity first."""
    return [(_px(item.row_px), _px(item.row_largest_px)) for item in result.sensitivities]


def _px(value: float) -> str:
    if not math.isfinite(value):
        return MISSING
    return number(value) if value > 1e-9 else "0"


def _print_rows(result: ToleranceResult) -> None:
    as_seen = not result.rig.is_rectified
    heads = ["distance\nm", "build, first\norder", "simu-\nlated"]
    heads += ["not\nrectified"] * as_seen
    heads += ["median\nrig", "95th\npercentile", "median re-\ncalibrated", "95th\npercentile"]
    print_table(
        "Rows of the same rigs: right row off the left one, px, root mean square over the image",
        heads,
        [
            (
                plain(item.depth_m),
                _px(item.first_order_row_px),
                _px(item.built.row_rms_px),
                *([_px(item.row_as_seen_px)] * as_seen),
                *(
                    MISSING if rigs is None else _px(percentile_mm(rigs.row_px, level))
                    for rigs in (item.built, item.recalibrated)
                    for level in (50, 95)
                ),
            )
            for item in result.depths
        ],
        numeric=[True] * len(heads),
    )


def variance_heads() -> tuple[str, ...]:
    """Heads of the table of shares; a newline starts a second line."""
    return (
        _head(col.QUANTITY),
        "first\norder",
        _head(col.SOBOL["first"], unit=False),
        _head(col.SOBOL["total"], unit=False),
        "sampling\nerror",
        _head(col.SOURCE),
    )


def variance_rows(result: ToleranceResult) -> list[tuple[str, ...]]:
    """Rows of the table of shares, the worst quantity first: first order beside Sobol indices, in percent."""
    rows: list[tuple[str, ...]] = []
    for item in result.sensitivities:
        shares = (MISSING, MISSING, MISSING)
        if result.interactions is not None:
            error, place = result.interactions.error, result.interactions.place(item.key)
            sampling = max(error.first_se[place], error.total_se[place])
            shares = (
                _share(error.first[place]),
                _share(error.total[place]),
                percent(sampling) if sampling > 1e-6 else "0",
            )
        source = result.tolerances.source(item.key)
        rows.append((result.tolerances.title(item.key), _share(item.share), *shares, source))
    return rows


def _share(value: float) -> str:
    """A share in percent; estimates of nothing may come out below it, and of all above."""
    return percent(min(value, 1.0)) if value > 1e-6 else "0"


def _tolerance(result: ToleranceResult, key: str, value: float) -> str:
    if math.isinf(value):
        return "any"
    if value == 0:
        return "none"
    return ("±" if result.tolerances.is_bound(key) else "") + number(value)


def tolerance_png(result: ToleranceResult) -> bytes:
    """PNG of `tolerance_figure`."""
    from rigsim.present.kit import style

    return style.to_png(tolerance_figure(result))


def tolerance_figure(result: ToleranceResult) -> Figure:
    """What each quantity does, and the share of rigs under each depth error."""
    from rigsim.present.kit import style

    with style.styled():
        below: dict[str, Any] = {
            "loc": "upper center",
            "bbox_to_anchor": (0.42, -0.2),
            "ncols": 3,
            "handlelength": 1.2,
            "columnspacing": 1.0,
        }
        figure = style.new_figure(style.PAGE_WIDTH_IN, _HEIGHT_IN)
        bars = style.place(figure, 1.68, 0.85, 1.95, 2.4)
        rows = [item for item in result.sensitivities if item.share > 1e-12][::-1]
        place = np.arange(len(rows))
        common = np.array([abs(item.common_mm) for item in rows])
        bars.barh(place + 0.2, common, 0.38, color=style.BLUE, label="common")
        bars.barh(
            place - 0.2,
            [item.differing_mm for item in rows],
            0.38,
            color=style.ORANGE,
            label="varies across the image",
        )
        bars.set_yticks(place, [QUANTITIES.get(item.key, item.key) for item in rows])
        bars.grid(visible=False, axis="y")
        at = f"{plain(result.required.depth_m)} m"
        bars.set_xlabel(f"depth error at {at}, mm")
        bars.set_title("Each alone, first order")
        bars.legend(**below)

        shares = style.place(figure, 4.35, 0.85, 2.65, 2.4)
        curves = [("as built", result.judged.built.whole_mm, style.VERMILION)]
        if result.judged.recalibrated is not None:
            curves.append(("recalibrated", result.judged.recalibrated.whole_mm, style.GREEN))
        for label, errors, colour in curves:
            errors_mm = np.sort(errors)
            # rigs that lose a point never come under any bound
            seen = errors_mm[np.isfinite(errors_mm) & (errors_mm > 0)]
            level = 100 * np.arange(1, len(seen) + 1) / len(errors_mm)
            shares.plot(seen, level, color=colour, label=label)
        bound_mm = result.required.error_m * 1e3
        shares.axvline(bound_mm, color=style.INK, linestyle="--", linewidth=1.0, label="required")
        finite = np.concatenate([errors[np.isfinite(errors) & (errors > 0)] for _, errors, _ in curves])
        ends = np.percentile(finite, (1, 99)) if len(finite) else np.array([bound_mm, bound_mm])
        low, high = min(float(ends[0]), bound_mm / 2), max(float(ends[1]), bound_mm * 2)
        style.plain_axis(shares, "x", low, high, style.scale_of(np.array([low, high])), max_ticks=5)
        shares.set_ylim(0, 101)
        shares.set_xlabel(f"depth error at {at}, mm")
        shares.set_ylabel("rigs under it, %")
        shares.set_title("Built rigs with pixel noise" if result.noise_px else "Built rigs")
        shares.legend(**below)
    return figure
