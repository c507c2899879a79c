"""Output folders are whole or absent, whatever happens in between."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from rigsim.errors import OutputError
from rigsim.interop.files import folder
from rigsim.interop.files.folder import check_output, write_folder

FILES = {"report.html": b"<html>", "sweep.csv": b"a,b\n"}


def contents(path: Path) -> dict[str, bytes]:
    return {str(file.relative_to(path)): file.read_bytes() for file in path.rglob("*") if file.is_file()}


def fail_on(name: str, code: int) -> Callable[[Path, bytes], None]:
    """A writer that writes half of the file called `name`, then fails as a disk does."""

    def write(path: Path, content: bytes) -> None:
        path.write_bytes(content[: len(content) // 2] if path.name == name else content)
        if path.name == name:
            raise OSError(code, os.strerror(code), str(path))

    return write


def test_a_new_folder_holds_the_files_and_nothing_else(tmp_path: Path) -> None:
    write_folder(tmp_path / "a" / "b" / "out", FILES)
    assert contents(tmp_path) == {f"a/b/out/{name}": content for name, content in FILES.items()}


def test_an_empty_folder_is_filled(tmp_path: Path) -> None:
    write_folder(tmp_path, FILES)
    assert contents(tmp_path) == FILES


def test_permissions_are_those_of_any_new_folder(tmp_path: Path) -> None:
    write_folder(tmp_path / "out", FILES)
    (tmp_path / "plain").mkdir()
    assert (tmp_path / "out").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_a_folder_in_use_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "sweep.csv").write_bytes(b"old")
    with pytest.raises(OutputError, match=r"already holds sweep\.csv; choose another one, or add --force"):
        write_folder(tmp_path, FILES)
    assert contents(tmp_path) == {"sweep.csv": b"old"}


def test_force_replaces_own_names_and_keeps_the_others(tmp_path: Path) -> None:
    (tmp_path / "sweep.csv").write_bytes(b"old")
    (tmp_path / "thesis.tex").write_bytes(b"years of work")
    write_folder(tmp_path, FILES, force=True)
    assert contents(tmp_path) == {**FILES, "thesis.tex": b"years of work"}


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (errno.ENOSPC, "the disk is full; free some space"),
        (errno.EDQUOT, "quota"),
        (errno.EROFS, "the disk is read-only"),
        (errno.EACCES, "permission denied"),
        (errno.EIO, "choose another folder"),
    ],
)
def test_a_failing_disk_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: int, words: str
) -> None:
    monkeypatch.setattr(folder, "_write_through", fail_on("sweep.csv", code))
    with pytest.raises(OutputError, match=words) as raised:
        write_folder(tmp_path / "a" / "out", FILES)
    assert "\n" not in str(raised.value)
    assert list(tmp_path.iterdir()) == []


def test_a_failing_disk_leaves_the_old_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = {"report.html": b"old report", "sweep.csv": b"old table", "mine.txt": b"mine"}
    for name, content in old.items():
        (tmp_path / name).write_bytes(content)
    monkeypatch.setattr(folder, "_write_through", fail_on("sweep.csv", errno.ENOSPC))
    with pytest.raises(OutputError, match="disk is full"):
        write_folder(tmp_path, FILES, force=True)
    assert contents(tmp_path) == old


def test_an_interrupt_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(path: Path, content: bytes) -> None:
        path.write_bytes(content[:1])
        raise KeyboardInterrupt

    monkeypatch.setattr(folder, "_write_through", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_folder(tmp_path / "a" / "out", FILES)
    assert list(tmp_path.iterdir()) == []


def test_a_kill_leaves_no_file_under_its_final_name(tmp_path: Path) -> None:
    slow = (
        "import sys, time\nfrom pathlib import Path\nfrom rigsim.interop.files import folder\n"
        "def write(path, content):\n"
        "    path.write_bytes(content[:1])\n"
        "    print('half', flush=True)\n"
        "    time.sleep(600)\n"
        "folder._write_through = write\n"
        f"folder.write_folder(Path({str(tmp_path / 'out')!r}), {FILES!r})\n"
    )
    with subprocess.Popen([sys.executable, "-c", slow], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "half\n"
        process.kill()
    assert not (tmp_path / "out").exists()
    write_folder(tmp_path / "out", FILES)
    assert contents(tmp_path / "out") == FILES


@pytest.mark.parametrize("is_new", [True, False])
def test_another_run_that_was_faster_is_not_overwritten(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_new: bool
) -> None:
    if not is_new:
        (tmp_path / "out").mkdir()

    def write_while_another_finishes(path: Path, content: bytes) -> None:
        path.write_bytes(content)
        (tmp_path / "out").mkdir(exist_ok=True)
        (tmp_path / "out" / "sweep.csv").write_bytes(b"theirs")

    monkeypatch.setattr(folder, "_write_through", write_while_another_finishes)
    with pytest.raises(OutputError, match="another run"):
        write_folder(tmp_path / "out", FILES)
    assert contents(tmp_path) == {"out/sweep.csv": b"theirs"}


def test_check_accepts_what_can_be_written_and_touches_nothing(tmp_path: Path) -> None:
    (tmp_path / "used").mkdir()
    (tmp_path / "used" / "x").write_bytes(b"")
    before = sorted(tmp_path.rglob("*"))
    check_output(tmp_path / "new" / "deep")
    check_output(tmp_path / "used", force=True, names=["sweep.csv"])
    assert sorted(tmp_path.rglob("*")) == before


def test_check_refuses_files_in_the_way(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OutputError, match="is a file; choose a folder"):
        check_output(tmp_path / "file")
    with pytest.raises(OutputError, match="file is a file; choose another folder"):
        check_output(tmp_path / "file" / "deep" / "out")
    (tmp_path / "out" / "sweep.csv").mkdir(parents=True)
    with pytest.raises(OutputError, match=r"sweep\.csv is a folder there"):
        check_output(tmp_path / "out", force=True, names=FILES)


def test_check_refuses_what_is_not_writable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(OutputError, match="is not writable; choose another folder"):
        check_output(tmp_path / "out")


def test_check_refuses_a_full_disk(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"MB are free on its disk, must be >= \d+ MB"):
        check_output(tmp_path / "out", needed_bytes=10**18)


@pytest.mark.parametrize("name", ["", ".", "..", "../x", "a/b", "/etc/x"])
def test_names_cannot_leave_the_folder(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match="must be plain"):
        write_folder(tmp_path / "out", {name: b""})
    assert not (tmp_path / "out").exists()


def test_a_pipe_stays_a_pipe_and_gets_the_content(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(OutputError, match="pipe: "):  # nobody reads
        folder.write_file(pipe, b"lost")
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        folder.write_file(pipe, b"told")
        assert os.read(reader, 100) == b"told"
    finally:
        os.close(reader)
    assert pipe.is_fifo()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pipe"]


def test_a_full_device_is_one_line_and_stays_a_device() -> None:
    with pytest.raises(OutputError, match="/dev/full: "):
        folder.write_file(Path("/dev/full"), b"anything")
    folder.write_file(Path("/dev/null"), b"anything")
    assert Path("/dev/full").is_char_device()
    assert Path("/dev/null").is_char_device()


def test_a_link_keeps_leading_to_the_file_that_is_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"old")
    (tmp_path / "link").symlink_to("file")
    folder.write_file(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "file").read_bytes() == b"new"
