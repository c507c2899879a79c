"""One sweep as a page that explains itself: HTML without scripts, links or network."""

from __future__ import annotations

from markupsafe import Markup
from matplotlib.figure import Figure

from rigsim.present.kit import style
from rigsim.present.kit.footprint import footprint
from rigsim.present.kit.format import count, length
from rigsim.present.kit.page import Cover, data_uri, fill, flat
from rigsim.present.kit.topdown import topdown_figure
from rigsim.present.sweep import requirement_words, tables
from rigsim.present.sweep.measured_words import equivalent_noise_words, method_words, was_measured
from rigsim.present.sweep.plots import curves
from rigsim.present.sweep.plots.axes import PlotAxis, best_row, swept_axes
from rigsim.present.sweep.requirement_table import requirement_table
from rigsim.present.sweep.rig_table import rig_table
from rigsim.present.sweep.same import same_words
from rigsim.present.sweep.witness_table import witness_table
from rigsim.present.sweep.words import growth_words, verdict
from rigsim.study.agreement.agreement import kinds
from rigsim.study.scene import columns as col
from rigsim.study.sweep.comparison import row_of_bins
from rigsim.study.sweep.growth import growth_of
from rigsim.study.sweep.result import SweepResult


def showcase_figure(result: SweepResult) -> Figure:
    """The plan of the rig on show."""
    show = result.showcase
    return topdown_figure(
        show.rig, show.points_left, visible=show.visible, depth_error_m=show.depth_rmse_m, noise=show.noise
    )


def report_html(result: SweepResult, plan: Figure | None = None, cover: Cover | None = None) -> str:
    """The report of a sweep: verdict, rig, pictures, plots, tables, how to read it, how to make it again.

    `plan` is `showcase_figure(result)` when it is drawn already; `cover` is its own head.
    """
    plan_svg = style.to_svg(
        plan or showcase_figure(result), "plan", "Plan of the rig and its points, from above"
    )
    axes = swept_axes(result)
    figures = [
        {
            "svg": Markup(style.to_svg(curves.panel_figure(result, panel), panel.name, panel.title)),
            "kind": panel.kind,
            "title": panel.title,
            "note": panel.note,
        }
        for panel in curves.panels(result)
    ]
    show = result.showcase
    best = result.rows.iloc[show.row]
    provenance = dict(flat(result.provenance))
    command = provenance.pop("command", "")
    return fill(
        "report.html",
        title=_title(result, axes),
        cover=cover or Cover(),
        required=requirement_table(result),
        required_badge=requirement_words.badge(result),
        result=result,
        verdict=verdict(result),
        witnesses=witness_table(result),
        equivalent_noise=equivalent_noise_words(best),
        rig=rig_table(result),
        rig_words=_rig_words(result, axes),
        left=data_uri(show.image_left),
        right=data_uri(show.image_right),
        size=f"{show.rig.left.width} × {show.rig.left.height}",
        size_right=f"{show.rig.right.width} × {show.rig.right.height}",
        plan=Markup(plan_svg),
        plan_words=_plan_words(result),
        axis_figures=[figure for figure in figures if figure["kind"] != "heat"],
        heat_figures=[figure for figure in figures if figure["kind"] == "heat"],
        by_depth=tables.best_by_depth(result),
        rows=tables.all_rows(result),
        same=same_words(result),
        growth=_growth_words(result),
        agreement_badge=_agreement_badge(result),
        measured=was_measured(result.rows),
        method=method_words(best),
        scene=best[col.SCENE],
        n_trials=count(best[col.N_TRIALS]),
        command=command,
        provenance=provenance,
    )


def _agreement_badge(result: SweepResult) -> tuple[str, str]:
    """Class and words of the badge that says whether the witnesses agree: first of the rig on show."""
    own = result.rows[col.AGREEMENT].iloc[result.showcase.row]
    found, n = kinds(result.rows), len(result.rows)
    n_flagged, n_agrees, n_untold = (int((found == kind).sum()) for kind in ("flagged", "agrees", "untold"))
    if n_flagged:
        return "flagged", f"⚠ Flagged: {n_flagged} of {n} {'row' if n == 1 else 'rows'}"
    if own.kind == "untold":
        who = "the pictures" if own.witness == "measured" else "prediction and simulation"
        others = f"; in {n_agrees} of {n} rows they do" if n_agrees else ""
        return "untold", f"? Not enough to tell whether {who} agree{others}"
    who = "Three witnesses" if was_measured(result.rows) else "Prediction and simulation"
    others = f"; not enough to tell in {n_untold} of {n} rows" if n_untold else ""
    return "agrees", f"✓ {who} agree{others}"


def _title(result: SweepResult, axes: list[PlotAxis]) -> str:
    scene = best_row(result)[col.SCENE]
    names = [axis.heading for axis in axes]
    what = " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
    return f"Sweep of {what} in {scene}" if what else f"One stereo rig in {scene}"


def _rig_words(result: SweepResult, axes: list[PlotAxis]) -> str:
    """Which of the rigs is shown in detail."""
    if len(result.rows) == 1:
        return "The rig that was simulated."
    row = result.rows.iloc[result.showcase.row]
    where = ", ".join(f"{axis.heading} {axis.say(row[axis.column])}" for axis in axes)
    if result.requirements:
        return f"The rig of the answer, one of {count(len(result.rows))} configurations: {where}."
    return f"The best of {count(len(result.rows))} configurations: {where}."


def _growth_words(result: SweepResult) -> str:
    """How the error of the rig on show grows with depth, as a sentence; empty where there is none."""
    bins = result.by_depth[row_of_bins(result.rows, result.by_depth) == result.showcase.row]
    words = growth_words(growth_of(bins))
    return f"The error of the rig shown: {words}." if words else ""


def _plan_words(result: SweepResult) -> str:
    show = result.showcase
    single = int((~show.visible).sum())
    words = (
        f"Both cameras are drawn to scale, {length(show.rig.baseline_m)} apart. Each of the "
        f"{count(show.visible.sum())} coloured points is a truth point that both cameras see; its colour "
        "is the RMS of its depth error over all trials. The dark lines join points of equal predicted error."
    )
    if single:
        words += (
            f" The {count(single)} hollow points are seen by the left camera only, so they have no depth."
        )
    nearest = footprint(show.rig).nearest
    if nearest is not None and nearest[1] > 0:
        words += f" The dashed green line is the nearest depth that both cameras see, {length(nearest[1])}."
    return words
