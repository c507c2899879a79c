"""A comparison as a page: conclusion, figure, tables, how to read it, how to make it again."""

from __future__ import annotations

from markupsafe import Markup
from matplotlib.figure import Figure

from rigsim.present.compare.console import HEADS, NUMERIC, shown_noise_px, table_rows
from rigsim.present.compare.figure import comparison_figure, figure_pdf, figure_png
from rigsim.present.compare.words import headline, listed, sentences
from rigsim.present.kit import style
from rigsim.present.kit.format import count, plain
from rigsim.present.kit.page import fill, flat
from rigsim.present.verify.words import about
from rigsim.study.compare import columns as col
from rigsim.study.compare.judge import off_bound
from rigsim.study.compare.run import SPEED_RUNS, ComparisonResult


def comparison_files(result: ComparisonResult) -> dict[str, bytes]:
    """Name to content: compare.html, figure.png, figure.pdf."""
    figure = comparison_figure(result)
    return {
        "compare.html": comparison_html(result, figure).encode(),
        "figure.png": figure_png(figure),
        "figure.pdf": figure_pdf(figure),
    }


def comparison_html(result: ComparisonResult, figure: Figure) -> str:
    """The comparison as one page, without scripts, links or network; `figure` is `comparison_figure`'s."""
    provenance = dict(flat(dict(result.provenance)))
    command = provenance.pop("command", "")
    says = headline(result)
    off = off_bound(result)
    levels = []
    for noise_px in sorted(result.plan.noises_px):
        flags = off[result.rows[col.NOISE] == noise_px]
        levels.append((plain(noise_px), list(zip(table_rows(result, noise_px), flags, strict=True))))
    return fill(
        "compare.html",
        headline=says,
        sentences=sentences(result),
        left_out=result.left_out,
        triangulators=listed(result.triangulators),
        first=result.triangulators[0],
        figure=Markup(style.to_svg(figure, "compare", says)),
        heads=[head.replace("\n", " ") for head in HEADS],
        numeric=NUMERIC,
        levels=levels,
        shown=plain(shown_noise_px(result)),
        geometries=[(geometry.name, about(geometry)) for geometry in result.plan.chosen()],
        n_points=count(result.plan.n_points),
        seed=result.plan.seed,
        runs=SPEED_RUNS,
        command=command,
        provenance=provenance,
    )
