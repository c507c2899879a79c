"""The rig to take, what it achieves and who can build it: takes seconds, so it runs beside the page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rigsim.errors import RigsimError
from rigsim.studio.logic.design import feasible as logic
from rigsim.studio.logic.faults import plain
from rigsim.studio.state import State
from rigsim.study.design.solve import Candidate


@dataclass(frozen=True, slots=True, eq=False)
class DesignAdvice:
    """A design without proof, in words and files."""

    words: Mapping[str, str]
    """The words that it answers."""
    fault: str
    """Why there is none; else empty."""
    pick: Candidate | None = None
    """The rig to take."""
    pareto: tuple[Candidate, ...] = ()
    """The rigs that no other beats, in the order of the preference."""
    headline: str = ""
    """The rig in one sentence."""
    held: tuple[str, str] = ("untold", "")
    """How many built rigs hold it: kind, as a badge's, and words."""
    reasons: tuple[str, ...] = ()
    """Why this one, one sentence each."""
    building: tuple[str, ...] = ()
    """What its build must hold, the yields, and what limits them."""
    achieved: tuple[tuple[str, str, str, str], ...] = ()
    """Requirement, asked for, had by formula, verdict."""
    files: Mapping[str, bytes] | None = None
    """``rig.toml``, ``design.json`` and ``design.csv`` (the table)."""
    whole: bool = True
    """Whether built rigs are counted already."""


def first_pick(words: Mapping[str, str]) -> DesignAdvice:
    """The rig to take alone, which is known sooner: no rig is built yet."""
    from rigsim.api.kit.cameras import cameras_tried
    from rigsim.api.kit.requirements import DesignOptions, specified
    from rigsim.present.design.console import headline
    from rigsim.study.design.solve import solve

    try:
        options = DesignOptions(**logic.arguments(State(words)), proof=False)
        found = solve(specified(options), cameras_tried(options), options.prefer)
    except RigsimError as error:
        return DesignAdvice(words, plain(str(error)))
    return DesignAdvice(words, "", found.candidates[0], found.pareto, headline(found, ()), whole=False)


def advise(words: Mapping[str, str]) -> DesignAdvice:
    """Solve and count built rigs for the words of the page; never raises what a user can cause."""
    from rigsim.api.design import design
    from rigsim.interop.documents.text import json_text
    from rigsim.interop.files.tables import csv_bytes
    from rigsim.interop.formats.rig_toml import write_rig
    from rigsim.present.design import console
    from rigsim.present.design.tolerance import held_by, limit_says, tolerance_says
    from rigsim.present.kit.types import table

    state = State(words)
    try:
        made = design(**logic.arguments(state), proof=False, command=logic.command_line(state))
    except RigsimError as error:
        return DesignAdvice(words, plain(str(error)))
    found, held = made.found, made.tolerance
    document = made.document()
    pick = found.candidates[0]
    building = () if held is None else (limit_says(held), tolerance_says(held), console.yields_words(held))
    comment = f"rigsim design: {document['recommended']['reason']}"
    return DesignAdvice(
        words,
        "",
        pick,
        found.pareto,
        made.headline,
        ("untold", "no built rig can be judged") if held is None else held_by(held),
        tuple(map(_said, (*console.sentences(found, ()), *(remark.text for remark in made.remarks)))),
        building,
        tuple((row[0], logic.signs(row[1]), row[2], row[5]) for row in console.requirement_rows(found, ())),
        {
            "rig.toml": write_rig(made.rig, comment, made.sensor).encode(),
            "design.json": (json_text(document) + "\n").encode(),
            "design.csv": csv_bytes(table(document["pareto"])),
        },
    )


def report(words: Mapping[str, str]) -> bytes:
    """The HTML report of the words of the page.

    Raises:
        RigsimError: there is no such design.
    """
    from rigsim.api.design import design

    state = State(words)
    made = design(**logic.arguments(state), proof=False, command=logic.command_line(state))
    return made.files()["design.html"]


def asked(state: State) -> dict[str, str]:
    """The words that a design depends on: with the same ones it is the same."""
    return {name: state[name] for name in logic.OPTIONS if state[name]}


def _said(text: str) -> str:
    """A sentence in the page's words."""
    return logic.signs(plain(text))
