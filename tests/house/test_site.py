"""The documentation site: the commands on its pages run and print what is shown; every topic has its page."""

from __future__ import annotations

import re
import runpy
import shlex
import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest

from rigsim.cli.app import run
from tests.helpers.browser import serving

DOCS = Path(__file__).resolve().parents[2] / "docs"
README = (DOCS.parent / "README.md").read_text(encoding="utf-8")
USE_CASES = ("sweep", "design", "tolerance", "verify", "compare", "infer", "measure")


@dataclass(frozen=True)
class Page:
    """A page's commands in order, what it shows of their output, and the files it tells one to save."""

    path: Path
    commands: list[str]
    shown: dict[str, str]
    files: dict[str, str]


def read(path: Path) -> Page:
    text = path.read_text(encoding="utf-8")
    blocks = re.findall(r"^```(\w+)\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    commands, shown = [], {}
    for (kind, body), (next_kind, next_body) in zip(blocks, [*blocks[1:], ("", "")], strict=False):
        if kind == "sh":
            commands += [line for line in body.splitlines() if line.startswith("./run ")]
            if next_kind == "text":
                shown[commands[-1]] = next_body
    names = re.findall(r"`(\w+\.\w+)`:?\n\n```(?:py|none|xml|toml)\n", text)
    bodies = [body for kind, body in blocks if kind in ("py", "none", "xml", "toml")]
    assert len(names) == len(bodies), f"{path.name}: a file to save without a name"
    return Page(path, commands, shown, dict(zip(names, bodies, strict=True)))


PAGES = [read(DOCS / "first_hour.md"), *(read(path) for path in sorted(DOCS.glob("howto/*.md")))]
RUNS = [
    (page, command)
    for page in PAGES
    for command in page.commands
    if command not in README and not command.startswith("./run docs")
]


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, Path]:
    return {page.path: tmp_path_factory.mktemp(page.path.stem) for page in PAGES}


@pytest.mark.parametrize(
    ("page", "command"), RUNS, ids=[f"{page.path.stem}: {command[6:40]}" for page, command in RUNS]
)
def test_commands_of_a_page_run_and_print_what_is_shown(
    page: Page,
    command: str,
    folders: dict[Path, Path],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(folders[page.path])
    monkeypatch.setenv("COLUMNS", "100")
    for name, body in page.files.items():
        Path(name).write_text(body, encoding="utf-8")
    printed = printed_by(command, page.commands, capsys)
    assert_shown(page.shown.get(command, "...\n"), printed)


def test_the_python_of_the_how_to_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = (DOCS / "howto" / "python.md").read_text(encoding="utf-8")
    for example in re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE):
        exec(compile(example, "python.md", "exec"), {})
    printed = capsys.readouterr().out
    assert "mm of baseline gives" in printed
    # sigma_Z = Z^2 sqrt(2) sigma / (f B), f = 640 / tan 35 deg
    assert "29 mm at 3 m" in printed


def printed_by(command: str, commands: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """What one of a page's `commands` prints, earlier ones having been run where it reads what they write."""
    words = shlex.split(command.removeprefix("./run "))
    if words[0] == "studio":
        with serving(*words[1:]) as server:
            return server.said
    read_from = [word for before, word in zip(["", *words], words, strict=False) if before != "--out"]
    for earlier in commands[: commands.index(command)]:
        folder = out_of(earlier)
        needed = folder and any(f"{word}/".startswith(f"{folder}/") for word in read_from)
        if folder and needed and not Path(folder).exists():
            printed_by(earlier, commands, capsys)
    own = out_of(command)
    if own and Path(own).exists():  # a later one needed it first, in another order of the tests
        shutil.rmtree(own)
    code = run(words)
    printed, errors = capsys.readouterr()
    assert code == 0, errors
    return printed


def out_of(command: str) -> str | None:
    found = re.search(r"--out (\S+)", command)
    return found[1] if found else None


def assert_shown(shown: str, printed: str) -> None:
    """Every line shown is printed, in order, and nothing is left out but where ``...`` stands."""
    lines = [line.rstrip() for line in printed.strip().splitlines()]
    gap = False
    for line in shown.rstrip().splitlines():
        if line == "...":
            gap = True
            continue
        assert line in lines, f"not printed, or not in this order: {line}\n{printed}"
        place = lines.index(line)
        assert gap or place == 0, f"left out without '...': {lines[:place]}"
        lines, gap = lines[place + 1 :], False
    assert gap or not lines, f"left out without '...': {lines}"


@pytest.mark.parametrize("name", USE_CASES)
def test_every_use_case_has_its_page(name: str) -> None:
    assert (DOCS / "reference" / f"{name}.md").read_text(encoding="utf-8").startswith("# ")


def test_every_question_of_the_readme_has_a_how_to_page() -> None:
    questions = re.findall(r"^\*\*(\w[^*]*\?)\*\*|\*\*(With [^*]*\?|In my scene\?)\*\*", README, re.MULTILINE)
    index = (DOCS / "howto" / "index.md").read_text(encoding="utf-8")
    asked = [first or second for first, second in questions]
    assert len(asked) >= 10
    assert [question for question in asked if question not in index] == []


def test_every_file_that_a_page_names_is_there() -> None:
    named = set()
    for path in DOCS.glob("**/*.md"):
        if "_build" not in path.parts and "adr" not in path.parts:
            text = path.read_text(encoding="utf-8")
            named |= set(re.findall(r"`((?:rigsim|docs|tests|tools|models)/[\w/.]+)`", text))
            floors = re.findall(r"`((?:cli|api|study|present|interop)/[\w/.]+)`", text)
            named |= {f"rigsim/{below}" for below in floors}
    assert len(named) > 40
    missing = {name for name in named if "NAME" not in name and not (DOCS.parent / name).exists()}
    # the example of an axis that is not there, and the pattern of an example's name
    assert missing == {"rigsim/study/scene/axes/snr.py", "docs/gallery/NN_name.py"}


def test_drawings_are_as_their_script_makes_them() -> None:
    drawings = runpy.run_path(str(DOCS / "pictures" / "draw.py"))["DRAWINGS"]
    for name, draw in drawings.items():
        assert (DOCS / "pictures" / name).read_text(encoding="utf-8") == draw(), name


def test_the_gallery_has_ten_short_examples() -> None:
    examples = sorted((DOCS / "gallery").glob("*.py"))
    assert len(examples) >= 10
    for path in examples:
        lines = path.read_text(encoding="utf-8").splitlines()
        assert 10 <= len(lines) <= 40, path.name
