"""Design: from requirements to the region of feasible rigs, and the rig to take."""

from __future__ import annotations

from functools import partial
from html import escape

from nicegui import ui

from rigsim.present.live.region import region_chart
from rigsim.rig.quantity import (
    BASELINE,
    DISPARITY,
    HFOV,
    NOISE,
    PIXEL_PITCH,
    SENSOR_WIDTH,
    QuantityKind,
)
from rigsim.studio.kit.apart import apart
from rigsim.studio.kit.clipboard import copy
from rigsim.studio.kit.controls import action, choice, text_box
from rigsim.studio.kit.numbers import notes
from rigsim.studio.kit.session import Session
from rigsim.studio.kit.shell import frame
from rigsim.studio.logic.design import advice, feasible, trade_offs
from rigsim.studio.state import State

CLASSES = {"": "machined", "printed": "printed", "calibrated": "calibrated"}
_MAIN: tuple[tuple[str, str, QuantityKind | None, str], ...] = (
    ("range", "Working range, near:far", None, "as 0.5:3m"),
    ("depth_error", "Depth error, at most", None, "as 10mm@3m or 1%; several with commas"),
    ("fov", "Field of view ≥", HFOV, "any, deg"),
    ("cover", "Both see ≥", None, "as 2m@3m"),
    ("min_baseline", "Baseline ≥", BASELINE, "any, mm"),
    ("max_baseline", "Baseline ≤", BASELINE, "any, mm"),
    ("max_disparity", "Disparity search ≤", DISPARITY, "any, px"),
    ("min_overlap", "Overlap ≥", None, "50 % near"),
    ("noise", "Noise", NOISE, "0.25 px"),
    ("max_row_error", "Row error ≤", None, "any, px"),
)
_MORE: tuple[tuple[str, str, QuantityKind | None, str], ...] = (
    ("try_resolution", "Image sizes to try", None, "as 1280x720,1920x1080"),
    ("lens", "Lenses to try", None, "as 60,70deg, 900,1200px or 4,6mm"),
    ("sensor", "Sensors to try", None, "as imx296"),
    ("try_pixel_pitch", "Pixel pitch", PIXEL_PITCH, "as 3.45um"),
    ("try_sensor_width", "Sensor width", SENSOR_WIDTH, "as 6.4mm"),
    ("vfov", "Vertical view ≥", HFOV, "any, deg"),
    ("max_pixels", "Pixels ≤", None, "as 2MP"),
    ("body_width", "Body width", None, "of the sensor's"),
    ("nearest_focus", "Nearest focus", None, "as 0.3m"),
    ("build_share", "Left for the build", None, "50 %"),
)
"""Words, labels, what they must be, and what is meant where nothing is typed."""
_PREFER = {
    "": "buildable",
    "smallest": "smallest",
    "cheapest": "cheapest",
    "most-accurate": "most-accurate",
}
_CLICKED = """(event) => {
  const chart = getElement(CHART).chart, box = chart.getDom().getBoundingClientRect();
  const at = [event.clientX - box.left, event.clientY - box.top];
  if (chart.containPixel('grid', at)) emit(chart.convertFromPixel({seriesIndex: 0}, at));
}"""


def begin(state: State) -> State:
    """What the page shows for an address."""
    return feasible.begin(state)


def build(session: Session) -> None:
    """The page."""
    shown = DesignShown(session)
    with frame(session):
        ui.html("<h1>From requirements to a rig</h1>", sanitize=False)
        ui.label(
            "Say what must be measured, how well and where; see which rigs can do it, and take one."
        ).classes("rig-lead")
        with ui.element("div").classes("rig-columns"):
            with ui.element("section").classes("rig-panel").props('aria-label="Requirements"'):
                _controls(session)
            with ui.element("div").classes("rig-stack"):
                shown.place()
    session.watch(shown.follow)
    session.when_resting(shown.rested)
    shown.rested()


def _controls(session: Session) -> None:
    with ui.element("div").classes("rig-fields"):
        for word, label, kind, example in _MAIN:
            box = text_box(session, word, label, kind=kind, placeholder=example).props("hide-bottom-space")
            if word in ("range", "depth_error"):
                box.classes("rig-wide")
        choice(session, "class", "Who builds it", CLASSES)
        choice(session, "prefer", "Which rig first", _PREFER)
    more = ui.expansion("Cameras to try, and more").classes("w-full").props("dense")
    with more, ui.element("div").classes("rig-fields"):
        for word, label, kind, example in _MORE:
            box = text_box(session, word, label, kind=kind, placeholder=example).props("hide-bottom-space")
            if word in ("try_resolution", "lens", "sensor"):
                box.classes("rig-wide")
    with ui.element("div").classes("rig-buttons").style("margin-top:14px"):
        action("Reset defaults", lambda: session.show(feasible.reset(session.state)), icon="restart_alt")


class DesignShown:
    """What is on the page beside the form."""

    def __init__(self, session: Session) -> None:
        """Know what is feasible; nothing is placed yet."""
        self._session = session
        self._found = feasible.find(session.state)
        self._advice: advice.DesignAdvice | None = None
        self._busy = False
        self._says: tuple[str, tuple[feasible.WayOut, ...]] = ("", ())

    def place(self) -> None:
        """Lay it out."""
        self._said = ui.element("div").classes("w-full").props('aria-live="polite"')
        with ui.element("section").classes("rig-panel w-full").props('aria-label="Feasible region"'):
            self._region()
        with ui.element("section").classes("rig-panel w-full").props('aria-label="Recommended rig"'):
            ui.html("<h2>Recommended rig</h2>", sanitize=False)
            self._stale = ui.html("", sanitize=False).props('aria-live="polite"')
            self._pick = ui.html("", sanitize=False).classes("w-full")
            with ui.element("div").classes("rig-buttons").style("margin-top:12px") as self._actions:
                self._to_rig = ui.link("Show in Rig", "/rig").classes("rig-go")
                for name in ("rig.toml", "design.csv", "design.json"):
                    action(name, partial(self._download, name), icon="download")
                action("HTML report", self._report, icon="download")
        with ui.element("section").classes("rig-panel w-full").props('aria-label="Trade-offs"'):
            self._table()
        with ui.element("section").classes("rig-panel w-full").props('aria-label="Command"'):
            ui.html("<h2>The same on the command line</h2>", sanitize=False)
            with ui.element("div").classes("rig-buttons"):
                self._line = (
                    ui.label().classes("rig-command").style("flex:1 1 20em").props("data-testid=command")
                )
                action("Copy command", lambda: copy(feasible.command_line(self._session.state), "Command"))

    def _region(self) -> None:
        with ui.element("div").classes("rig-buttons"):
            ui.html("<h2>Feasible rigs</h2>", sanitize=False)
            self._size = choice(self._session, "region", "Image size shown", {"": "as recommended"})
        self._counted = ui.label().classes("rig-soft")
        self._chart = ui.echart({"series": []}, renderer="svg").classes("rig-graph rig-region")
        self._chart.props('role="img"')
        self._chart.on("click", self._clicked, js_handler=_CLICKED.replace("CHART", str(self._chart.id)))
        ui.label(
            "Click a point of the green area to see that rig; the table below has the same by keyboard."
        ).classes("rig-soft")

    def _table(self) -> None:
        ui.html("<h2>Trade-offs: rigs that no other beats</h2>", sanitize=False)
        self._heads: dict[str, ui.element] = {}
        with (
            ui.element("div")
            .classes("rig-scroll rig-tall")
            .props('tabindex=0 role=region aria-label="Table of trade-offs"'),
            ui.element("table").classes("rig-table"),
        ):
            with ui.element("thead"), ui.element("tr"):
                for name, column in trade_offs.COLUMNS.items():
                    with ui.element("th").classes("num") as head:
                        button = ui.element("button").props("type=button").classes("rig-sort")
                        with button:
                            ui.label(column.name)
                        button.on("click", partial(self._sort, name))
                    self._heads[name] = head
                for name in ("camera", "show"):
                    with ui.element("th"):
                        ui.label(name)
            self._body = ui.html("", sanitize=False, tag="tbody")

    def follow(self) -> None:
        """Draw what the words say at once."""
        state = self._session.state
        like = None
        if self._advice is not None and self._advice.pick is not None:
            like = self._advice.pick.camera.width_px, self._advice.pick.camera.height_px
        self._found = found = feasible.find(state, like)
        self._say()
        self._counted.set_text(found.counted)
        self._draw()
        self._line.set_text(feasible.command_line(state))
        current = self._is_current
        self._show_table()
        whole = current and self._is_whole
        self._stale.set_content("" if whole else self._waiting())
        self._pick.classes(remove="rig-stale") if current else self._pick.classes("rig-stale")
        self._pick.set_visibility(current or self._found.design is not None)
        self._actions.set_visibility(whole and self._advice is not None and not self._advice.fault)

    def rested(self) -> None:
        """Count built rigs of what the words say now, unless that is known or running."""
        if not self._busy and not self._is_current:
            ui.timer(0.01, self._advise, once=True)

    @property
    def _is_current(self) -> bool:
        return self._advice is not None and self._advice.words == advice.asked(self._session.state)

    @property
    def _is_whole(self) -> bool:
        return self._advice is not None and (self._advice.whole or bool(self._advice.fault))

    def _waiting(self) -> str:
        if self._found.fault:
            return "<p class=rig-soft>None: what the requirements need is said above.</p>"
        return "<p class=rig-soft>Built rigs are counted for these requirements …</p>"

    async def _advise(self) -> None:
        if self._busy:
            return
        self._busy = True
        try:
            while self._found.design is not None and not (self._is_current and self._is_whole):
                do = advice.advise if self._is_current else advice.first_pick
                made = await apart(do, advice.asked(self._session.state))
                if made is None:
                    return
                self._advice = made
                self._show_advice(made)
                self.follow()
        finally:
            self._busy = False

    def _show_advice(self, made: advice.DesignAdvice) -> None:
        if made.fault or made.pick is None:
            self._pick.set_content(notes(made.fault, ()))
            return
        headline = f"<p class=rig-headline data-testid=recommended>{escape(made.headline)}</p>"
        if not made.whole:
            self._pick.set_content(headline)
            return
        kind, text = made.held
        rows = "".join(
            f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in made.achieved
        )
        self._pick.set_content(
            f"{headline}<p><span class='rig-badge {kind}' data-testid=held>{escape(text)}</span></p>"
            f"{_list(made.reasons)}"
            "<div class=rig-scroll><table class=rig-table><thead><tr><th>requirement</th><th>asked for</th>"
            f"<th>by formula</th><th></th></tr></thead><tbody>{rows}</tbody></table></div>"
            f"<h3>When it is built</h3>{_list(made.building)}"
        )
        pick = made.pick
        size = pick.camera.width_px, pick.camera.height_px
        there = feasible.picked(self._session.state, pick.camera.focal_px, pick.baseline_m * 1e3, size)
        self._to_rig.props(f'href="{there.address("rig")}"')

    def _say(self) -> None:
        says = self._found.fault, self._found.ways
        if says == self._says:
            return
        self._says = says
        self._said.clear()
        with self._said:
            if self._found.fault:
                ui.html(notes(self._found.fault, ()), sanitize=False).classes("w-full")
            if self._found.ways:
                with ui.element("div").classes("rig-buttons"):
                    ui.label("Relax one:")
                    for way in self._found.ways:
                        if way.state is None:
                            ui.label(way.text)
                        else:
                            action(way.text, partial(self._session.show, way.state))

    def _draw(self) -> None:
        found = self._found
        self._offer_sizes()
        if found.region is None:
            return
        camera = found.region.camera
        candidates = feasible.of_size(() if found.design is None else found.design.candidates, camera)
        marks = [(one.camera.focal_px, one.baseline_m * 1e3) for one in candidates]
        pick = None
        if self._advice is not None and self._is_current and self._advice.pick is not None:
            best = feasible.of_size([self._advice.pick], camera)
            pick = (best[0].camera.focal_px, best[0].baseline_m * 1e3) if best else None
        self._chart.options.clear()
        self._chart.options.update(region_chart(found.region, marks, pick))
        self._chart.update()
        size = f"{camera.width_px}x{camera.height_px} px"
        self._chart.props(f'aria-label="Feasible baselines over focal lengths with {size}"')
        self._counted.set_text(f"{found.counted} Shown: baselines over focal lengths with {size}.".strip())

    def _offer_sizes(self) -> None:
        """Put the image sizes that are tried into the list; one that was chosen stays in it."""
        chosen = self._session.state["region"]
        sizes = {"": "as recommended"}
        sizes |= {text: f"{text} px" for text in map(feasible.size_text, self._found.sizes)}
        sizes.setdefault(chosen, f"{chosen} px, not tried")
        if self._size.options != sizes:
            self._size.set_options(sizes, value=chosen)

    def _show_table(self) -> None:
        state = self._session.state
        found = () if self._found.design is None else self._found.design.pareto
        if self._is_current and self._advice is not None and self._advice.pareto:
            found = self._advice.pareto
        for name, head in self._heads.items():
            head.props(f"aria-sort={trade_offs.direction(state['sort'], name)}")
        self._body.set_content("".join(_row(row) for row in trade_offs.rows(state, found)))

    def _sort(self, name: str) -> None:
        self._session.type(sort=trade_offs.next_sort(self._session.state["sort"], name))

    def _clicked(self, event: object) -> None:
        from nicegui.events import GenericEventArguments

        assert isinstance(event, GenericEventArguments)
        focal_px, baseline_mm = (float(f"{float(value):.4g}") for value in event.args)
        shown = self._found.region
        if shown is None:
            return
        failing = feasible.broken(self._found, focal_px, baseline_mm)
        if failing:
            ui.notify(
                f"{baseline_mm:.4g} mm with {focal_px:.4g} px fails {' and '.join(failing)}", type="warning"
            )
            return
        size = shown.camera.width_px, shown.camera.height_px
        ui.navigate.to(feasible.picked(self._session.state, focal_px, baseline_mm, size).address("rig"))

    def _download(self, name: str) -> None:
        if self._advice is not None and self._advice.files is not None:
            ui.download.content(self._advice.files[name], name)

    async def _report(self) -> None:
        ui.notify("The report is being made: some seconds")
        page = await apart(advice.report, advice.asked(self._session.state))
        if page is not None:
            ui.download.content(page, "design.html")


def _list(sentences: tuple[str, ...]) -> str:
    return f"<ul class=rig-list>{''.join(f'<li>{escape(one)}</li>' for one in sentences)}</ul>"


def _row(row: trade_offs.TradeRow) -> str:
    cells = "".join(f"<td class=num>{escape(cell)}</td>" for cell in row.cells[:-1])
    says = f"Show the rig of {row.cells[0]} mm and {row.cells[1]} px in Rig"
    return (
        f"<tr>{cells}<td>{escape(row.cells[-1])}</td>"
        f"<td><a class=rig-show href='{escape(row.address)}' aria-label='{escape(says)}'>Show</a></td></tr>"
    )
