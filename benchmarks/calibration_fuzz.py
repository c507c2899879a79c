"""Calibrations made wrong: each is read or refused in one line and in time, and never a traceback.

With ``RIGSIM_CALIBRATIONS=FOLDER`` the folders in it are forms as well.
"""

from __future__ import annotations

import os
import random
import tempfile
import time
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from benchmarks.subjects.calibrations import calibrations, mutated
from rigsim.errors import RigsimError
from rigsim.interop.formats.calibration import read
from rigsim.interop.formats.kit.reading import RigReading

CASES = 10_000
SEED = 1
LIMIT_S = 2.0
LONGEST = 1000
SAID = (
    RigReading(),
    RigReading(),
    RigReading(unit="mm", size_px=(1280, 720)),
    RigReading(cameras=("1", "0")),
)


def run() -> None:
    """Print how many cases of each form were read and refused, the slowest, and every fault."""
    forms, chance = calibrations(), random.Random(SEED)
    folder = os.environ.get("RIGSIM_CALIBRATIONS")
    if folder:
        own = (path for path in sorted(Path(folder).iterdir()) if path.is_dir())
        forms |= {f"folder {path.name}": _files(path) for path in own}
    whole = {name: content for files in forms.values() for name, content in files.items()}
    counts: Counter[tuple[str, str]] = Counter()
    faults: list[str] = []
    slowest = (0.0, "")
    with tempfile.TemporaryDirectory() as place:
        for case in range(CASES):
            form = sorted(forms)[case % len(forms)]
            path = Path(place, str(case))
            path.mkdir()
            _write(path, mutated(forms[form], whole, chance))
            said = chance.choice(SAID)
            begin = time.process_time()
            verdict, fault = judged(_named(path, chance), said)
            taken = time.process_time() - begin
            slowest = max(slowest, (taken, f"{form}, case {case}"))
            counts[form, verdict] += 1
            faults += [f"{form}, case {case}: {fault}"] if fault else []
            faults += [f"{form}, case {case}: {taken:.1f} s"] if taken > LIMIT_S else []
            for file in path.iterdir():
                file.unlink()
    print(f"{'form':28} {'read':>6} {'refused':>8}")
    for form in sorted(forms):
        print(f"{form:28} {counts[form, 'read']:6} {counts[form, 'refused']:8}")
    took = f"the slowest took {slowest[0]:.2f} s ({slowest[1]})"
    print(f"{CASES} cases of seed {SEED}: {len(faults)} faults; {took}")
    for text in faults[:20]:
        print(text)


def judged(paths: list[Path], said: RigReading) -> tuple[str, str]:
    """``read`` or ``refused``, and what is wrong with the answer, if anything."""
    try:
        read(paths, said)
    except RigsimError as error:
        text = str(error)
        wrong = "\n" in text or not text.isprintable() or len(text) > LONGEST
        return "refused", f"not one line: {text[:300]!r}" if wrong else ""
    except Exception as error:  # what must not be
        return "refused", f"{type(error).__name__}: {error}"[:300]
    return "read", ""


def _named(path: Path, chance: random.Random) -> list[Path]:
    """The folder, a file of it, or two."""
    files = sorted(path.iterdir())
    count = chance.randint(0, min(2, len(files)))
    return chance.sample(files, count) or [path]


def _files(folder: Path) -> Mapping[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


def _write(folder: Path, files: Mapping[str, bytes]) -> None:
    for name, content in files.items():
        (folder / name).write_bytes(content)
