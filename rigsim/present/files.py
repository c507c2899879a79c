"""The files of a report as bytes; writing them is the caller's business."""

from __future__ import annotations

from rigsim.present import curves, report, style
from rigsim.present.pictures import encode
from rigsim.study.result import SweepResult


def sweep_files(result: SweepResult) -> dict[str, bytes]:
    """Name to content: report.html, topdown.png, depth_error.png, left.png and right.png."""
    plan = report.showcase_figure(result)
    return {
        "report.html": report.report_html(result, plan).encode("utf-8"),
        "topdown.png": style.to_png(plan),
        "depth_error.png": style.to_png(curves.depth_error_figure(result), dpi=110),
        "left.png": encode(result.showcase.image_left),
        "right.png": encode(result.showcase.image_right),
    }
