"""Forms that are right, and the same with mistakes: a rig, or one line."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.calibration_fuzz import judged
from benchmarks.subjects.calibrations import calibrations, mutated
from rigsim.interop.formats.calibration import read
from rigsim.interop.formats.kit.reading import RigReading

FORMS = calibrations()
WHOLE = {name: content for files in FORMS.values() for name, content in files.items()}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_is_read_as_it_is(form: str, tmp_path: Path) -> None:
    for name, content in FORMS[form].items():
        (tmp_path / name).write_bytes(content)
    assert read([tmp_path]).rig.baseline_m == pytest.approx(0.1, abs=0.021)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(sorted(FORMS)), st.integers(0, 2**32))
def test_with_mistakes_it_is_a_rig_or_one_line(tmp_path: Path, form: str, seed: int) -> None:
    chance = random.Random(seed)
    for path in tmp_path.iterdir():
        path.unlink()
    for name, content in mutated(FORMS[form], WHOLE, chance).items():
        (tmp_path / name).write_bytes(content)
    files = sorted(tmp_path.iterdir())
    for paths in ([tmp_path], files[:1]):
        assert not paths or judged(paths, RigReading())[1] == ""
