"""Prove it: the three witnesses for the rig that is shown."""

from __future__ import annotations

from html import escape

from nicegui import ui

from rigsim.studio.draw.proof import ProofRequest, ProofRun, ProvedRig
from rigsim.studio.draw.request import Failed
from rigsim.studio.kit.clipboard import copy
from rigsim.studio.kit.controls import action
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.logic import scenes
from rigsim.studio.logic.numbers import RigNumbers
from rigsim.studio.logic.proof import ProofLine, lines, proof_wanted

_HEADS = ("points", "predicted", "simulated", "measured", "expected of it", "n", "verdict")
_STALE = "These are of another rig: prove this one, or put the controls back."


class ProofView:
    """The proof of one tab, and which rig it is of."""

    def __init__(self, session: Session, numbers: Latest[RigNumbers]) -> None:
        """Place it."""
        self._session, self._numbers = session, numbers
        self._run = ProofRun()
        self._proved: ProvedRig | None = None
        self._gone = False
        ui.context.client.on_delete(self._leave)
        with ui.element("section").classes("rig-panel w-full").props('aria-label="Proof"'):
            with ui.element("div").classes("rig-titled"):
                ui.html("<h2>Predicted, simulated, measured</h2>", sanitize=False)
                with ui.element("div").classes("rig-buttons"):
                    self._button = action("Prove it", self.prove, icon="science", flat=False)
                    self._cancel = action("Cancel", self._run.cancel)
            self._bar = ui.linear_progress(0.0, show_value=False).props('aria-label="Progress of the proof"')
            self._said = ui.html(_INVITES, sanitize=False).props('aria-live="polite" data-testid=proof-said')
            self._result = ui.html("", sanitize=False).classes("rig-scroll").props("data-testid=proof")
            with ui.element("div").classes("rig-buttons").style("margin-top:10px") as self._after:
                self._line = ui.label().classes("rig-command").style("flex:1 1 20em")
                self._line.props("data-testid=command-proof")
                action("Copy command", lambda: copy(self._line.text, "Command"))
                action("Report", lambda: self._download("report"), icon="download")
                action("rig.toml", lambda: self._download("rig"), icon="download")
        self._show_running(False)
        self._after.set_visibility(False)

    async def prove(self) -> None:
        """Run the witnesses for the rig that is shown now."""
        request = self._request()
        if request is None:
            self._tell(self._numbers().fault)
            return
        self._show_running(True)
        answer = await self._run.prove(request, self._progress)
        if self._gone:
            return
        self._show_running(False)
        if isinstance(answer, Failed):
            self._tell(answer.text)
            return
        self._proved = answer
        self._after.set_visibility(True)
        self._line.set_text(answer.command)
        self.follow()

    def follow(self) -> None:
        """Mark what was proved as of another rig, or of this one again."""
        if self._proved is None:
            return
        stale = self._proved.request != self._request()
        self._result.set_content(_table(self._proved, stale=stale))
        first = f'<div class="rig-note" data-testid=proof-stale>{_STALE}</div>' if stale else ""
        self._said.set_content(first or _headline(self._proved))

    def _request(self) -> ProofRequest | None:
        return proof_wanted(self._numbers(), scenes.chosen(self._session.state, self._session.own_scene))

    def _progress(self, share: float, words: str) -> None:
        if not self._gone:
            self._bar.set_value(share)
            self._said.set_content(f"<span class=rig-soft>{escape(words)} …</span>")

    def _tell(self, fault: str) -> None:
        self._said.set_content(f'<div class="rig-fault" role="alert">{escape(fault)}</div>')

    def _show_running(self, running: bool) -> None:
        self._button.set_enabled(not running)
        self._cancel.set_visibility(running)
        self._bar.set_visibility(running)

    def _download(self, what: str) -> None:
        if self._proved is not None:
            content, name = (
                (self._proved.report, "report.html")
                if what == "report"
                else (self._proved.rig_toml, "rig.toml")
            )
            ui.download(content, name)

    def _leave(self) -> None:
        self._gone = True
        self._run.cancel()


_INVITES = (
    "<span class=rig-soft>One press renders the scene, triangulates noisy points of it, and measures in the "
    "pictures: three answers that agree, or are flagged.</span>"
)


def _headline(proved: ProvedRig) -> str:
    look = "agrees" if proved.agrees else "flagged"
    rest = "".join(f"<div class=rig-soft>{escape(text)}</div>" for text in (*proved.verdict, *proved.remarks))
    return (
        f'<div><span class="rig-badge {look}" data-testid="proof-verdict">{look}</span> '
        f"<b>{escape(proved.headline)}</b></div>{rest}"
    )


def _table(proved: ProvedRig, *, stale: bool) -> str:
    body = "".join(_row(line) for line in lines(proved))
    heads = "".join(
        f"<th scope=col{' class=num' if 0 < place < 6 else ''}>{name}{', mm' if 0 < place < 5 else ''}</th>"
        for place, name in enumerate(_HEADS)
    )
    says = (
        f"Depth error, root mean square, in scene {escape(proved.scene)}; measured by {escape(proved.method)}"
    )
    return (
        f"<table class='rig-table rig-proof{' rig-stale' if stale else ''}' style='margin-top:10px'>"
        f"<caption>{says}</caption><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>"
    )


def _row(line: ProofLine) -> str:
    cells = "".join(
        f"<td class=num>{escape(value)}</td>"
        for value in (line.predicted, line.simulated, line.measured, line.expected, line.n)
    )
    why = f" <span class=rig-soft>{escape(line.why)}</span>" if line.why else ""
    badge = f'<span class="rig-badge {escape(line.verdict)}">{escape(line.verdict)}</span>{why}'
    return f"<tr><th scope=row>{escape(line.where)}</th>{cells}<td>{badge}</td></tr>"


def proof(session: Session, numbers: Latest[RigNumbers]) -> None:
    """Place the proof."""
    view = ProofView(session, numbers)
    session.watch(view.follow)
