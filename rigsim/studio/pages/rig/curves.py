"""The depth error and the overlap over distances, as one chart."""

from __future__ import annotations

from nicegui import background_tasks, run, ui

from rigsim.present.live.curves import curve_options, fill_curves
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.logic.curves import RigCurves, curves_of
from rigsim.studio.logic.numbers import RigNumbers


def curves(session: Session, numbers: Latest[RigNumbers]) -> None:
    """Place the chart; how its axes run is no part of the state, as it changes no number."""
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Curves"'):
        with ui.element("div").classes("rig-titled"):
            ui.html("<h2>Depth error and overlap over the working range</h2>", sanitize=False)
            scale = ui.toggle({False: "linear", True: "logarithmic"}, value=False)
            scale.props('dense no-caps unelevated aria-label="Axes"').classes("rig-toggle")
        chart = ui.echart(curve_options(log=False)).classes("rig-chart").props("data-testid=curves")

    def show(shown: RigCurves) -> None:
        fill_curves(chart.options, shown.depth, shown.overlap, shown.required)
        chart.update()

    def refresh() -> None:
        show(curves_of(numbers(), resting=False))

    async def whole() -> None:
        found = numbers()
        shown = await run.io_bound(curves_of, found)
        if shown is not None and found is numbers():
            show(shown)

    def rest() -> None:
        found = numbers().shown
        if found is not None and not found.rig.is_rectified:
            background_tasks.create(whole(), name="curves")

    def rescale() -> None:
        chart.options.clear()
        chart.options.update(curve_options(log=bool(scale.value)))
        refresh()
        rest()

    scale.on_value_change(rescale)
    session.watch(refresh)
    session.when_resting(rest)
    rest()
