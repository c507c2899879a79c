"""./run and ./check on a pretended machine: what is set up, when, and what is said when it cannot be.

Python, pip, apt and the checking tools are stand-ins that note how they were called, so no test needs a
network or touches the system.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
PYTHONS = ("python3.13", "python3.12", "python3.11", "python3")

PYTHON = """#!/bin/sh
case "$*" in
    -V) echo "Python 3.12.9" ;;
    -c*ensurepip*) [ ! -e "$FAKES/no-venv-module" ] ;;
    -c*) ;;
    "-m venv "*)
        echo venv >>"$FAKES/calls"
        mkdir -p "$3/bin"
        cp "$0" "$3/bin/python"
        echo "VIRTUAL_ENV='$3'" >"$3/bin/activate"
        ;;
    "-m pip --version") ;;
    "-m pip install"*)
        echo "pip $*" >>"$FAKES/calls"
        if [ -e "$FAKES/pip-hangs" ]; then echo $$ >"$FAKES/pip-pid"; exec sleep 60; fi
        if [ -e "$FAKES/pip-fails" ]; then cat "$FAKES/pip-fails"; exit 1; fi
        for tool in rigsim ruff mypy lint-imports; do
            printf '#!/bin/sh\\necho %s "$@"\\n[ ! -e "$FAKES/%s-fails" ]\\n' $tool $tool >"${0%/*}/$tool"
            chmod +x "${0%/*}/$tool"
        done
        ;;
    tools/docs.py*) echo "python $*" ; [ ! -e "$FAKES/docs-fail" ] ;;
    *) echo "python $*" ; [ ! -e "$FAKES/tests-fail" ] ;;
esac
"""
ID = """#!/bin/sh
if [ -e "$FAKES/is-root" ]; then echo 0; else echo 1000; fi
"""
APT_GET = """#!/bin/sh
echo "apt-get $*" >>"$FAKES/calls"
[ ! -e "$FAKES/apt-fails" ]
"""
DPKG_QUERY = """#!/bin/sh
if [ -e "$FAKES/has-gl" ]; then echo "install ok installed"; else exit 1; fi
"""


@dataclass
class Machine:
    """A checkout on a machine of stand-ins."""

    root: Path
    fakes: Path

    def start(self, *words: str, cwd: Path | None = None) -> subprocess.Popen[str]:
        environment = {
            "PATH": f"{self.fakes}/bin:/usr/bin:/bin",
            "FAKES": str(self.fakes),
            "HOME": str(self.fakes),
        }
        return subprocess.Popen(
            [str(self.root / words[0]), *words[1:]],
            env=environment,
            cwd=cwd,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def call(self, *words: str, cwd: Path | None = None) -> tuple[int, str, str]:
        with self.start(*words, cwd=cwd) as process:
            out, err = process.communicate()
        return process.returncode, out, err

    def tell(self, name: str, content: str = "") -> None:
        (self.fakes / name).write_text(content)

    def calls(self) -> list[str]:
        """What was called since the last time."""
        path = self.fakes / "calls"
        lines = path.read_text().splitlines() if path.exists() else []
        path.unlink(missing_ok=True)
        return lines


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    root, fakes = tmp_path / "a checkout", tmp_path / "fakes"
    (root / "tools").mkdir(parents=True)
    (fakes / "bin").mkdir(parents=True)
    for name in ("run", "check", "tools/setup.sh", "pyproject.toml", "constraints.txt"):
        shutil.copy(CHECKOUT / name, root / name)
    others = {"id": ID, "apt-get": APT_GET, "dpkg-query": DPKG_QUERY, "chromium": "", "chromedriver": ""}
    stand_ins = dict.fromkeys(PYTHONS, PYTHON) | others
    for name, text in stand_ins.items():
        (fakes / "bin" / name).write_text(text)
        (fakes / "bin" / name).chmod(0o755)
    return Machine(root, fakes)


SETTING_UP = "rigsim: setting up .venv (once, about a minute)\n"


def test_first_call_sets_up_and_every_call_runs_the_program(machine: Machine, tmp_path: Path) -> None:
    assert machine.call("run", "sweep", "--baseline", "50:500", "two words") == (
        0,
        "rigsim sweep --baseline 50:500 two words\n",
        SETTING_UP,
    )
    venv, pip = machine.calls()
    assert venv == "venv"
    assert pip.endswith("-c constraints.txt -e .[vision]")
    # then quiet, from anywhere, and through a link
    assert machine.call("run", "--version", cwd=tmp_path) == (0, "rigsim --version\n", "")
    link = tmp_path / "fakes" / "bin" / "link"
    link.symlink_to(machine.root / "run")
    assert machine.call(str(link), "x") == (0, "rigsim x\n", "")
    assert machine.calls() == []


def test_studio_brings_what_the_page_needs_and_keeps_it(machine: Machine) -> None:
    code, out, _ = machine.call("run", "studio", "--no-browser")
    assert (code, out) == (0, "rigsim studio --no-browser\n")
    assert machine.calls()[1].endswith("-e .[vision,studio]")
    for words in (("run", "studio"), ("run", "--version")):
        machine.call(*words)
    assert machine.calls() == []


def test_the_program_s_exit_code_is_kept(machine: Machine) -> None:
    machine.tell("rigsim-fails")
    assert machine.call("run")[0] == 1


@pytest.mark.parametrize("name", ["pyproject.toml", "constraints.txt"])
def test_a_changed_file_installs_again_into_the_same_venv(machine: Machine, name: str) -> None:
    machine.call("run")
    machine.calls()
    with (machine.root / name).open("a") as file:
        file.write("\n")
    assert machine.call("run")[2] == SETTING_UP
    (pip,) = machine.calls()
    assert pip.startswith("pip")
    assert machine.call("run")[2] == ""


def test_another_python_installs_again(machine: Machine) -> None:
    machine.call("run")
    machine.calls()
    python = machine.root / ".venv" / "bin" / "python"
    python.write_text(python.read_text().replace("3.12.9", "3.12.10"))
    assert machine.call("run")[2] == SETTING_UP
    assert [line.split()[0] for line in machine.calls()] == ["pip"]


def test_a_moved_checkout_gets_a_new_venv(machine: Machine) -> None:
    machine.call("run")
    machine.calls()
    moved = Machine(machine.root.rename(machine.root.parent / "moved"), machine.fakes)
    assert moved.call("run")[2] == SETTING_UP
    assert [line.split()[0] for line in moved.calls()] == ["venv", "pip"]
    assert moved.call("run")[2] == ""


def test_a_venv_that_somebody_broke_is_made_anew(machine: Machine) -> None:
    machine.call("run")
    machine.calls()
    (machine.root / ".venv" / "bin" / "python").unlink()
    assert machine.call("run") == (0, "rigsim\n", SETTING_UP)
    assert machine.calls()[0] == "venv"


def test_check_adds_the_tools_and_serves_run_too(machine: Machine) -> None:
    machine.call("run")
    machine.calls()
    assert machine.call("check")[0] == 0
    (pip,) = machine.calls()
    assert pip.endswith("-e .[dev,vision,studio]")
    assert machine.call("run")[2] == ""
    assert machine.call("check")[2] == ""
    assert machine.calls() == []


def test_check_prints_a_line_a_step_and_the_output_of_what_failed(machine: Machine) -> None:
    code, out, _ = machine.call("check")
    assert code == 0
    lines = out.splitlines()
    assert [line.split()[:2] for line in lines] == [
        ["ok", name] for name in ("format", "lint", "types", "imports", "docs", "tests")
    ]
    machine.tell("mypy-fails")
    machine.tell("tests-fail")
    code, out, _ = machine.call("check")
    assert code == 1
    lines = out.splitlines()
    assert [line.split()[:2] for line in lines if line.startswith(("ok", "FAILED"))] == [
        ["ok", "format"],
        ["ok", "lint"],
        ["FAILED", "types"],
        ["ok", "imports"],
        ["ok", "docs"],
        ["FAILED", "tests"],
    ]
    assert "mypy" in lines
    assert any(line.startswith("python -m pytest") for line in lines)


def test_a_fast_check_runs_what_the_change_can_break(machine: Machine) -> None:
    code, out, _ = machine.call("check", "--fast")
    assert code == 0
    *steps, said = out.splitlines()
    assert [line.split()[:2] for line in steps] == [
        ["ok", name] for name in ("format", "lint", "types", "imports", "tests")
    ]
    assert said.split() == ["python", "tools/fast.py"]
    machine.tell("tests-fail")
    assert machine.call("check", "--fast")[0] == 1
    assert machine.call("check", "--quick")[::2] == (2, "usage: ./check [--fast]\n")


def test_a_set_up_killed_half_way_heals(machine: Machine) -> None:
    machine.tell("pip-hangs")
    with machine.start("run") as process:
        while not (machine.fakes / "pip-pid").exists():
            time.sleep(0.01)
        os.killpg(process.pid, signal.SIGKILL)
    (machine.fakes / "pip-hangs").unlink()
    machine.calls()
    (machine.root / ".venv" / "lib").mkdir()
    (machine.root / ".venv" / "lib" / "half-a-package").touch()
    assert machine.call("run") == (0, "rigsim\n", SETTING_UP)
    assert machine.calls()[0] == "venv"
    assert not (machine.root / ".venv" / "lib").exists()
    assert machine.call("run")[2] == ""


def test_an_interrupt_ends_the_set_up_and_the_next_call_heals(machine: Machine) -> None:
    machine.tell("pip-hangs")
    with machine.start("run") as process:
        while not (machine.fakes / "pip-pid").exists():
            time.sleep(0.01)
        os.killpg(process.pid, signal.SIGINT)
        process.communicate()
    assert process.returncode == 130
    (machine.fakes / "pip-hangs").unlink()
    assert machine.call("run") == (0, "rigsim\n", SETTING_UP)


def test_two_calls_at_once_install_once(machine: Machine) -> None:
    with machine.start("run", "one") as one, machine.start("run", "two") as two:
        outs = [process.communicate()[0] for process in (one, two)]
    assert (one.returncode, two.returncode) == (0, 0)
    assert outs == ["rigsim one\n", "rigsim two\n"]
    assert len(machine.calls()) == 2


def test_a_failing_pip_is_explained_and_tried_again(machine: Machine) -> None:
    for log, reason in (
        (
            "WARNING: ... NewConnectionError ...\nERROR: No matching distribution found for numpy",
            "no network",
        ),
        ("WARNING: ... SSLError(...) ...\nERROR: No matching distribution found for numpy", "certificate"),
        ("ERROR: No matching distribution found for numpy==9", "No matching distribution found for numpy==9"),
        ("Segmentation fault", "pip install failed"),
    ):
        machine.tell("pip-fails", log)
        code, out, err = machine.call("run")
        assert (code, out) == (1, "")
        message = err.removeprefix(SETTING_UP)
        assert message.startswith("rigsim: error: ")
        assert message.count("\n") == 1
        assert reason in message
    (machine.fakes / "pip-fails").unlink()
    assert machine.call("run")[:2] == (0, "rigsim\n")


def test_without_python_an_ordinary_account_is_told_what_to_install(machine: Machine) -> None:
    for name in PYTHONS:
        (machine.fakes / "bin" / name).write_text("#!/bin/sh\nexit 1\n")
    code, _, err = machine.call("run")
    assert code == 1
    assert "no Python >= 3.11 found: install one" in err
    assert machine.calls() == []
    assert not (machine.root / ".venv").exists()


def test_without_the_venv_module_an_ordinary_account_is_told_what_to_install(machine: Machine) -> None:
    machine.tell("no-venv-module")
    code, _, err = machine.call("run")
    assert code == 1
    assert "python3.13 has no venv module" in err
    assert "apt-get install python3-venv" in err


def test_root_installs_what_the_system_lacks(machine: Machine) -> None:
    machine.tell("is-root")
    machine.tell("no-venv-module")
    assert machine.call("run")[0] == 1  # apt's stand-in installs nothing
    assert machine.calls() == [
        "apt-get update -qq",
        "apt-get install -y -qq --no-install-recommends libegl1 libopengl0 libgl1-mesa-dri",
        "apt-get install -y -qq --no-install-recommends python3 python3-venv",
    ]


def test_check_needs_a_compiler_too(machine: Machine) -> None:
    machine.tell("is-root")
    assert machine.call("check")[0] == 0
    assert [line for line in machine.calls() if line.startswith("apt-get")] == [
        "apt-get update -qq",
        "apt-get install -y -qq --no-install-recommends libegl1 libopengl0 libgl1-mesa-dri",
        "apt-get install -y -qq --no-install-recommends g++",
        "apt-get install -y -qq --no-install-recommends chromium chromium-driver",
    ]


def test_root_with_everything_calls_no_apt(machine: Machine) -> None:
    machine.tell("is-root")
    machine.tell("has-gl")
    assert machine.call("run") == (0, "rigsim\n", SETTING_UP)
    assert [line.split()[0] for line in machine.calls()] == ["venv", "pip"]


def test_an_ordinary_account_leaves_gl_alone(machine: Machine) -> None:
    assert machine.call("run")[0] == 0
    assert [line.split()[0] for line in machine.calls()] == ["venv", "pip"]


def test_without_gl_the_program_still_runs(machine: Machine) -> None:
    machine.tell("is-root")
    machine.tell("apt-fails")
    code, out, err = machine.call("run")
    assert (code, out) == (0, "rigsim\n")
    assert err.splitlines()[1].startswith("rigsim: GL could not be installed")
    assert err.endswith("rays only\n")


def test_bench_runs_the_benchmarks(machine: Machine) -> None:
    assert machine.call("run", "bench", "startup")[1] == "python -m benchmarks startup\n"


def test_docs_builds_the_site_with_what_check_needs(machine: Machine) -> None:
    code, out, _ = machine.call("run", "docs", "--no-serve")
    assert (code, out) == (0, "python tools/docs.py --no-serve\n")
    assert machine.calls()[1].endswith("-e .[dev,vision,studio]")
    machine.tell("docs-fail")
    assert machine.call("run", "docs")[0] == 1
    code, out, _ = machine.call("check")
    assert code == 1
    assert [line.split()[1] for line in out.splitlines() if line.startswith("FAILED")] == ["docs"]


@pytest.mark.parametrize("name", ["run", "check", "tools/setup.sh"])
def test_scripts_are_plain_sh(name: str) -> None:
    shell = shutil.which("dash") or "sh"
    assert (
        subprocess.run([shell, "-n", CHECKOUT / name], capture_output=True, text=True, check=True).stderr
        == ""
    )


def test_scripts_can_be_executed() -> None:
    for name in ("run", "check", ".ci/run"):
        assert os.access(CHECKOUT / name, os.X_OK), name


def test_constraints_hold_versions_and_nothing_else() -> None:
    lines = (CHECKOUT / "constraints.txt").read_text().splitlines()
    assert lines
    for line in lines:
        name, equals, version = line.partition("==")
        assert equals, line
        assert name.replace("-", "").replace("_", "").isalnum(), line
        assert all(part.isalnum() for part in version.split(".")), line
