"""What the documents say is so: commands run, shown output is real, links lead somewhere."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from pathlib import Path
from typing import Any

import pytest

from rigsim.cli.app import run
from rigsim.testing import assert_triangulates
from tests.helpers.browser import serving

ROOT = Path(__file__).resolve().parents[2]
DOCS = [
    *ROOT.glob("*.md"),
    *(path for path in ROOT.glob("docs/**/*.md") if "_build" not in path.parts),
    *ROOT.glob("models/**/*.md"),
    ROOT / "reports" / "README.md",
]
README = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", README, re.DOTALL)
COMMANDS = [line for kind, body in BLOCKS if kind == "sh" for line in body.splitlines()]
SHOWN = [
    (body.strip(), BLOCKS[i + 1][1])
    for i, (kind, body) in enumerate(BLOCKS[:-1])
    if kind == "sh" and BLOCKS[i + 1][0] == "text"
]


SMALLER = {"sweep": "--measure none --points 200 --trials 20", "compare": "--points 300"}
"""Said after a command whose output the page does not show: the same words, with less to compute."""


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    return tmp_path


def test_the_first_commands_are_the_entrances():
    assert COMMANDS[:3] == ["./run studio", "./run sweep --baseline 50:500", "./check"]


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("readme")
    (folder / "docs").symlink_to(ROOT / "docs")  # whose examples it reads
    return folder


@pytest.mark.parametrize("command", [command for command in COMMANDS if command.startswith("./run ")])
def test_commands_run(
    command: str, shared: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.chdir(shared)
    monkeypatch.setenv("COLUMNS", "100")
    for earlier in COMMANDS[: COMMANDS.index(command)]:
        folder = re.search(r"--out (\S+)", earlier)
        # this one reads what an earlier one wrote, here or in another process
        if folder and f" {folder[1]}/" in command and not (shared / folder[1]).exists():
            assert run(shlex.split(earlier.removeprefix("./run "))) == 0
            capsys.readouterr()
    own = re.search(r"--out (\S+)", command)
    if own and (shared / own[1]).exists():  # a later one needed it first
        shutil.rmtree(shared / own[1])
    words = shlex.split(command.removeprefix("./run "))
    if words[0] == "studio":
        with serving(*words[1:]):
            return  # it says where it is, once the page can be opened
    if command not in dict(SHOWN):
        words += SMALLER.get(words[0], "").split()
    assert run(words) == 0, capsys.readouterr().err
    printed = capsys.readouterr().out
    for shown_command, shown in SHOWN:
        if shown_command == command:
            # the folder's name holds the time
            assert _timeless(printed) == _timeless(shown)


def _timeless(text: str) -> str:
    return re.sub(r"-\d{8}-\d{6}", "-TIME", "\n".join(line.rstrip() for line in text.strip().splitlines()))


def test_the_python_example_runs(elsewhere: Path, capsys: pytest.CaptureFixture[str]):
    (example,) = (body for kind, body in BLOCKS if kind == "python")
    exec(compile(example, "README.md", "exec"), {})
    assert "agrees" in capsys.readouterr().out


def test_the_failing_triangulation_fails_as_shown(elsewhere: Path, capsys: pytest.CaptureFixture[str]):
    wrong, test = (body for kind, body in BLOCKS if kind == "py")
    ((command, shown),) = (
        body.removeprefix("$ ").split("\n", 1) for kind, body in BLOCKS if kind == "console"
    )
    (elsewhere / "my_stereo.py").write_text(wrong)
    assert run(shlex.split(command.removeprefix("rigsim "))) == 3
    assert _timeless(capsys.readouterr().out) == _timeless(shown)
    # mended as the text says, it passes the test below
    module: dict[str, Any] = {}
    exec(wrong.replace("(right, left, uv", "(left, right, uv"), module)
    (only,) = re.findall(r"only=(\[.*?\])", test)
    assert_triangulates(module["triangulate"], only=json.loads(only))
    exec(wrong, module)
    with pytest.raises(AssertionError, match="swapped-images"):
        assert_triangulates(module["triangulate"], only=json.loads(only))


@pytest.mark.parametrize("path", DOCS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(path: Path):
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", path.read_text()):
        # the site makes its gallery when it is built
        if not target.startswith(("http://", "https://", "../auto_gallery/")):
            assert (path.parent / target).exists(), f"{path.name}: {target}"


def test_the_changelog_is_kept():
    changelog = (ROOT / "CHANGELOG.md").read_text()
    assert "## [Unreleased]" in changelog
    assert "### Added" in changelog


def test_the_gallery_names_the_commands_that_make_it():
    text = (ROOT / "reports" / "README.md").read_text()
    made = sorted(path.name for path in (ROOT / "reports" / "gallery").iterdir())
    assert made == sorted(re.findall(r"\(gallery/([\w-]+)/(?:report|plan)\.html\)", text))
    for name in made:
        assert f"--out reports/gallery/{name} --force" in text


def test_nothing_in_the_repository_is_large():
    docs = [path for path in ROOT.glob("docs/**/*") if "_build" not in path.parts]
    for path in [*docs, *ROOT.glob("reports/gallery/**/*"), *ROOT.glob("models/**/*")]:
        assert not path.is_file() or path.stat().st_size < 2_000_000, path


def test_the_page_of_design_shows_what_the_readme_shows():
    page = (ROOT / "docs" / "reference" / "design.md").read_text()
    (shown,) = [body for command, body in SHOWN if command.startswith("./run design")]
    assert shown.replace("reports/design/", "reports/design-TIME/") in page
