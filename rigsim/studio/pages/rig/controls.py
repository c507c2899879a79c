"""What is known of the rig, and what is asked of it."""

from __future__ import annotations

from collections.abc import Mapping

from nicegui import events, ui

from rigsim.errors import RigsimError
from rigsim.rig.presets import PRESETS
from rigsim.rig.quantity import BASELINE, DEPTH, FOCAL_PX, HFOV, NOISE, VERGENCE
from rigsim.studio.kit.controls import Span, action, text_box
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.logic import lenses, scenes
from rigsim.studio.logic.numbers import RigNumbers
from rigsim.studio.pages.rig.sliders import Knob, Standing, knob, range_knob
from rigsim.studio.state import State

MOST_BYTES = 10_000_000
"""No calibration is larger."""
_LENS = ("hfov", "focal", "sensor_width", "pixel_pitch")
_BASELINE = Knob("baseline", "Baseline", BASELINE, Span(5, 2000, unit="mm"))
_NARROW = Knob("hfov", "Field of view", HFOV, Span(10, 150, log=False, unit="deg"), clears=_LENS[1:])
_LONG = Knob("focal", "Focal length", FOCAL_PX, Span(100, 8000, unit="px"), clears=("hfov", *_LENS[2:]))
_VERGENCE = Knob("vergence", "Vergence", VERGENCE, Span(-10, 30, log=False, unit="deg"))
_NOISE = Knob("noise", "Noise", NOISE, Span(0.02, 2, unit="px"), hint="of each pixel coordinate, std")
_DISTANCE = Knob("z", "Distance", DEPTH, Span(0.1, 50, unit="m"), hint="where the numbers are told")
_FILE = "file"


def controls(session: Session, numbers: Latest[RigNumbers], defaults: State) -> None:
    """Every control of the page."""

    def standing() -> Mapping[str, str]:
        found = numbers()
        at = "2m" if found.distances is None else f"{found.distances.at_mm / 1e3:.4g}m"
        return {**lenses.standing(found.shown), "z": at}

    _origin(session, numbers)
    with ui.element("div").classes("rig-controls"):
        knob(session, _BASELINE, standing)
        _lens(session, standing)
        _size(session, standing)
        knob(session, _VERGENCE, standing)
        knob(session, _NOISE, standing)
        ui.html("<h2>What it is for</h2>", sanitize=False)
        range_knob(session, "Working range", Span(0.1, 50, unit="m"), standing)
        text_box(
            session, "require", "Depth error allowed", hint="10mm@3m, 1%@2m; p95:20mm@3m", placeholder="none"
        )
        knob(session, _DISTANCE, standing)
        _scene(session)
        action("Reset defaults", lambda: session.show(defaults), icon="restart_alt")


def _origin(session: Session, numbers: Latest[RigNumbers]) -> None:
    names = {lenses.OWN: "own rig", **{name: f"{name} · {made.about}" for name, made in PRESETS.items()}}

    def current() -> str:
        return _FILE if lenses.is_from_file(session.state) else session.state["preset"]

    def options() -> dict[str, str]:
        return {**names, _FILE: "from a file"} if lenses.is_from_file(session.state) else names

    def chosen(name: str) -> None:
        if name not in (_FILE, current()):
            session.show(lenses.with_preset(session.state, name, numbers().shown))

    select = ui.select(options(), label="Preset", value=current() if current() in options() else lenses.OWN)
    select.on_value_change(lambda event: chosen(event.value))
    select.props("dense outlined options-dense").classes("w-full")
    _upload(session)

    def follow() -> None:
        name = current() if current() in options() else lenses.OWN
        if select.options != options():
            select.set_options(options(), value=name)
        elif select.value != name:
            select.set_value(name)

    session.watch(follow, now=False)


def _upload(session: Session) -> None:
    said = ui.html("", sanitize=True).props('aria-live="polite"')

    async def taken(event: events.UploadEventArguments) -> None:
        try:
            session.show(lenses.with_file(session.state, event.file.name, await event.file.read()))
            said.set_content("")
        except RigsimError as error:
            _fault(said, str(error))
        upload.reset()

    upload = ui.upload(
        auto_upload=True,
        max_file_size=MOST_BYTES,
        max_files=1,
        on_upload=taken,
        on_rejected=lambda: _fault(said, f"the file is not taken: at most {MOST_BYTES // 1_000_000} MB"),
    )
    upload.style("display: none")
    # the browser opens its dialogue for a hand's own click, so the click does not go to the server first
    button = ui.button("Load a calibration", icon="upload_file").props("no-caps outline color=primary")
    button.on("click", js_handler=f"() => getElement({upload.id}).pickFiles()")
    button.classes("w-full").style("margin-top: 8px")
    button.tooltip("rig.toml, OpenCV, ROS, Kalibr, Middlebury, KITTI, ...: what --rig reads")


def _fault(said: ui.html, text: str) -> None:
    from html import escape

    said.set_content(f'<div class="rig-fault" role="alert" data-testid="upload-fault">{escape(text)}</div>')


def _lens(session: Session, standing: Standing) -> None:
    kinds = {"hfov": "field of view", "focal": "focal length"}
    toggle = ui.toggle(kinds, value="focal" if session.state["focal"] else "hfov")
    toggle.props('dense no-caps unelevated aria-label="Lens by"').classes("rig-toggle")
    for what in (_NARROW, _LONG):
        knob(session, what, standing).bind_visibility_from(toggle, "value", value=what.word)

    def follow() -> None:
        # what was typed is what is shown, in whichever way
        typed = next((word for word in kinds if session.state[word]), "")
        if typed and toggle.value != typed:
            toggle.set_value(typed)

    session.when_restored(follow)


def _size(session: Session, standing: Standing) -> None:
    with ui.element("div").classes("rig-fields"):
        box = text_box(session, "resolution", "Resolution", placeholder="1280x720")
        select = ui.select(list(lenses.SIZES), label="Usual sizes, px").props("dense outlined options-dense")

    def current() -> str:
        return session.state["resolution"] or standing()["resolution"]

    def chosen(size: str | None) -> None:
        if size and size != current():
            box.set_value(size)

    select.on_value_change(lambda event: chosen(event.value))

    def follow() -> None:
        box.props(f'placeholder="{standing()["resolution"]}"')
        known = current() if current() in lenses.SIZES else None
        if select.value != known:
            select.set_value(known)

    session.watch(follow)


def _scene(session: Session) -> None:
    choices = scenes.choices(session.own_scene)
    select = ui.select(choices, label="Scene", value=scenes.chosen(session.state, session.own_scene))
    select.props("dense outlined options-dense").classes("w-full")
    select.on_value_change(lambda event: session.type(scene=event.value))

    def follow() -> None:
        name = scenes.chosen(session.state, session.own_scene)
        if select.value != name:
            select.set_value(name)

    session.watch(follow, now=False)
