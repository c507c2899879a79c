"""Commands are loaded when they are called, and help says of each what it says of itself."""

from __future__ import annotations

import importlib

import pytest
import typer

from rigsim.cli.app import COMMANDS, app, run
from tests.helpers.processes import modules_after

PLACES = {command.place.partition(":")[0] for command in COMMANDS.values()}


def test_help_loads_no_command() -> None:
    assert modules_after("--help") & PLACES == set()


def test_one_command_loads_no_other() -> None:
    assert modules_after("presets") & PLACES == {"rigsim.cli.presets"}


@pytest.mark.parametrize("name", COMMANDS)
def test_the_line_of_a_command_is_its_own_first_line(name: str) -> None:
    module, _, attribute = COMMANDS[name].place.partition(":")
    command = getattr(importlib.import_module(module), attribute)
    text = command.info.help if isinstance(command, typer.Typer) else command.__doc__
    assert COMMANDS[name].says == text.strip().splitlines()[0]
    assert typer.main.get_command(app).commands[name].name == name


def test_a_name_that_is_nearly_one_is_offered(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["swep"]) == 2
    assert "no such command 'swep'. Did you mean 'sweep'?" in capsys.readouterr().err
