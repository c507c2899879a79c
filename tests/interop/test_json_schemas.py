"""The schemas of docs/schema: made from the documents' types, closed, with units in the names."""

from __future__ import annotations

import copy
import json
import os
import re
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer
from jsonschema import Draft202012Validator

from rigsim.cli.app import app, run
from rigsim.interop.documents.schema import DOCUMENTS
from rigsim.interop.documents.schema import schema as made
from rigsim.interop.documents.sweep import DepthRow, OverallRow
from rigsim.study.scene.columns import DEPTH_COLUMNS, ROW_COLUMNS
from tests.helpers.documents import SCHEMAS, schema, valid, validator

PAGE = (SCHEMAS.parent / "reference" / "json.md").read_text(encoding="utf-8")

UNITS = re.compile(r"_(mm|m|px|deg|um|e|ms|m_s|deg_s|pct|fraction|share)$")
WITHOUT_UNIT = {
    *("n", "n_matches", "n_tried", "n_truth", "n_points", "n_visible", "n_trials", "measured_n"),  # counts
    *("n_pairs", "n_inconsistent"),  # counts
    *("count", "measured_count", "points", "trials", "rigs", "cameras_tried", "bits"),
    *("best", "board", "recommended", "seed"),  # places and numbers that name something
    *("features", "pictures"),
    *("as_built_se", "as_built_rigs", "recalibrated_se", "recalibrated_rigs"),  # shares and counts
    *("recalibrated_informed", "yield", "yield_se"),  # shares
    *("as_built", "recalibrated", "margin", "confidence_level", "first_over_simulated"),  # shares, ratios
    "share",  # of a picture
    *("exponent", "exponent_ci_low", "exponent_ci_high"),
    *("nees", "predicted_over_simulated", "measured_over_predicted", "measured_within_3_sigma"),  # ratios
    *("measured_scale", "measured_scale_ci_low", "measured_scale_ci_high"),  # ratios of error to claim
    *("pixel_error_over_bound", "pixel_error_over_bound_se", "bound_se", "depth_error_over_bound"),
    *("pixel_error_over_first", "pixel_error_over_first_se", "speed_over_first", "expected_failed_share_se"),
    *("depth_bias_over_std", "depth_bias_over_std_se", "expected_depth_bias_over_std", "points_per_second"),
    *("rows", "row", "passed", "inefficient", "failed", "error", "not_applicable"),  # counts of verify
    *("same", "within_tolerance", "within_noise", "moved", "new", "gone", "efficiency"),
    *("false_alarm", "explained"),  # shares
    *("coefficients", "rotation"),
    *("columns", "poses", "calibrations", "pictures_needed", "pictures_enough"),  # counts
    *("misfit", "parameter_ratio", "parameter_ratio_low", "parameter_ratio_high", "boards", "unfound"),
    *("across", "down", "gain", "correlation", "ratio", "ratio_low", "ratio_high"),  # shares, ratios
    "left_from_board",  # three rad, three m
    *("leave_one_out_ratio", "chance", "beyond_chance"),  # ratios, a probability
    *("corners", "std"),  # counts; of a parameter, which names its unit
    *("baseline_shift_std", "depth_shift_std"),  # in standard deviations
    "seconds",
    "frames",
    "pixels",
    "value",  # a published figure, whose `quantity` ends in its unit
    *("smallest", "median", "largest"),  # of a quantity that names its unit
}


def test_every_command_takes_json() -> None:
    commands = dict(_answering())
    assert {"sweep", "calc point", "render", "doctor"} <= commands.keys()
    for name, command in commands.items():
        assert any("--json" in option.opts for option in command.params), name


def _answering() -> Iterator[tuple[str, Any]]:
    """The commands that end with an answer; the page goes on until it is interrupted."""
    for name, command in _commands(typer.main.get_command(app), ()):
        if name != "studio":
            yield name, command


def _commands(command: Any, path: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
    for name, inner in getattr(command, "commands", {}).items():
        yield from _commands(inner, (*path, name))
    if not hasattr(command, "commands"):
        yield " ".join(path), command


def test_the_schemas_are_those_of_the_documents() -> None:
    held = {path.name.removesuffix(".schema.json") for path in SCHEMAS.iterdir()}
    assert held == set(DOCUMENTS)
    for name in DOCUMENTS:
        assert schema(name) == made(name), "run .venv/bin/python tools/schemas.py"


def test_every_command_has_a_schema_and_a_line_in_the_docs() -> None:
    shown = set(
        re.findall(
            r"^\| `rigsim ([^`]*) --json` \| \[[^]]*\]\(\.\./schema/([\w-]+)\.schema\.json\)", PAGE, re.M
        )
    )
    assert shown == {
        (command.removeprefix("rigsim ").removesuffix(" --json"), name)
        for name, (command, _) in DOCUMENTS.items()
    }
    commands = {name for name, _ in _answering()}
    assert {command.replace(" NAME", "") for command, _ in shown} == commands


@pytest.mark.parametrize("name", DOCUMENTS)
def test_a_schema_is_one_and_leaves_no_key_open(name: str) -> None:
    Draft202012Validator.check_schema(schema(name))
    for node in _objects(schema(name)):
        assert node["additionalProperties"] is False
        assert set(node["required"]) == set(node["properties"])
        assert all(says.get("description") or "$ref" in str(says) for says in node["properties"].values())


@pytest.mark.parametrize("name", DOCUMENTS)
def test_numbers_have_their_unit_in_the_name(name: str) -> None:
    for node in _objects(schema(name)):
        for key, says in node["properties"].items():
            kinds = str(says)
            if "'number'" in kinds or "'integer'" in kinds:
                named = key in WITHOUT_UNIT or UNITS.search(key)
                assert named or "unit" in node["required"], key  # or the unit stands beside it


def _objects(node: Any) -> Iterator[dict[str, Any]]:
    if isinstance(node, dict):
        if "properties" in node:
            yield node
        for inner in node.values():
            yield from _objects(inner)


def test_unknown_missing_and_mistyped_keys_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    words = "sweep --baseline 60 --measure none --points 50 --trials 2 --resolution 160x120 --renderer rays"
    assert run([*words.split(), "--json"]) == 0
    document = valid("sweep", capsys.readouterr().out)
    spoilt = []
    for place in ((), ("rows", 0), ("by_depth", 0), ("provenance",), ("verdict",)):
        for spoil in (_add, _drop, _mistype):
            other = copy.deepcopy(document)
            node: Any = other
            for step in place:
                node = node[step]
            spoil(node)
            spoilt.append(other)
    assert not any(validator("sweep").is_valid(other) for other in spoilt)


def _add(node: dict[str, Any]) -> None:
    node["surprise"] = 1


def _drop(node: dict[str, Any]) -> None:
    node.popitem()


def _mistype(node: dict[str, Any]) -> None:
    node[next(iter(node))] = {}


def test_the_rows_are_those_of_the_tables() -> None:
    assert tuple(OverallRow.model_fields) == (*ROW_COLUMNS, "limited_by", "diagnosis", "requirement")
    assert set(DepthRow.model_fields) == set(DEPTH_COLUMNS)


# --- the examples of docs/reference/json.md ---

PIPED = [line.split(" | jq ") for line in re.findall(r"^rigsim .* \| jq .*$", PAGE, re.M)]


@pytest.mark.parametrize("command", dict.fromkeys(command for command, _ in PIPED))
def test_the_examples_print_what_their_filters_take(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    words = shlex.split(command)[1:]
    if words[0] == "sweep":  # the keys are the same with less to do
        words += ["--points", "200", "--trials", "20", "--measure", "none"]
    assert run(words) == 0, capsys.readouterr().err
    text = json.dumps(valid(words[0], capsys.readouterr().out))
    for key in re.findall(r"[a-z]\w+", " ".join(taken for piped, taken in PIPED if piped == command)):
        assert f'"{key}"' in text or key == "csv"


def test_the_python_example_runs(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(SCHEMAS.parent.parent)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}:{os.environ['PATH']}")
    (example,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(example, "json.md", "exec"), {})
    # Z^2 / (f B) times 0.25 px and sqrt(2), with 882.5 px and 75 mm: 48.08 mm
    assert capsys.readouterr().out == "48.1 mm at 3 m\n"
