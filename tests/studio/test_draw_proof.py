"""A proof runs in a process of its own, says what the command line says, and can be cancelled."""

from __future__ import annotations

import asyncio
import json
import os
import shlex
import signal
from dataclasses import replace
from pathlib import Path

import pytest

from rigsim import Intrinsics, RigsimError, StereoRig
from rigsim.studio.draw.proof import CANCELLED, ProofRequest, ProofRun, ProvedRig, prove_here
from rigsim.studio.draw.request import Failed
from tests.helpers.cli import rigsim
from tests.helpers.processes import wait_for_end

RIG = StereoRig.rectified(Intrinsics.from_focal(640, 360, 450.0), 0.12)
QUICK = ProofRequest(RIG, points=60, trials=10, measure="corners", seed=4)


def told(*_: object) -> None:
    """A progress that nobody looks at."""


def test_a_proof_gives_three_numbers_and_the_report() -> None:
    heard: list[tuple[float, str]] = []
    found = asyncio.run(ProofRun().prove(QUICK, lambda share, words: heard.append((share, words))))
    assert isinstance(found, ProvedRig)
    whole = found.whole
    assert whole.predicted_mm is not None
    assert whole.simulated_mm is not None
    assert whole.measured_mm is not None
    assert whole.measured_predicted_mm is not None
    assert whole.simulated_mm == pytest.approx(whole.predicted_mm, rel=0.2)
    assert whole.measured_mm == pytest.approx(whole.measured_predicted_mm, rel=0.7)
    assert whole.measured_n > 50
    assert found.method == "corners"
    assert (found.scene, whole.near_mm) == ("boards", None)
    nears = [part.near_mm for part in found.bins]
    assert nears == sorted(nears)
    spans = [(part.near_mm, part.depth_mm, part.far_mm) for part in found.bins if part.depth_mm is not None]
    assert len(spans) > 3
    assert all(near <= depth <= far for near, depth, far in spans)
    assert "120 mm of baseline" in found.headline
    assert found.agrees is not whole.agreement.startswith("flagged")
    assert any("sees" in sentence or "see" in sentence for sentence in found.verdict)
    page = found.report.decode()
    assert found.headline[:40] in page
    assert found.command in page
    assert 'src="data:image' in page
    assert 'src="left' not in page  # needs no file beside it
    shares = [share for share, _ in heard]
    assert shares == sorted(shares)
    assert heard[0] == (0.0, "starting")


def test_the_command_gives_the_same_numbers(tmp_path: Path) -> None:
    asked = replace(QUICK, measure="none", noise_px=0.3)
    found = prove_here(asked, told)
    assert found.whole.measured_mm is None
    (tmp_path / "rig.toml").write_bytes(found.rig_toml)
    words = shlex.split(found.command)
    assert words[0] == "rigsim"
    said = json.loads(rigsim(*words[1:], "--json", cwd=tmp_path).stdout)
    (row,) = said["rows"]
    assert row["depth_rmse_mm"] == pytest.approx(found.whole.simulated_mm, rel=1e-9)
    assert row["predicted_depth_rmse_mm"] == pytest.approx(found.whole.predicted_mm, rel=1e-9)
    assert said["verdict"]["headline"] == found.headline


def test_a_cancelled_proof_says_so_and_ends_its_process() -> None:
    async def main() -> None:
        proof = ProofRun()
        begun: list[str] = []
        task = asyncio.ensure_future(proof.prove(QUICK, lambda _, words: begun.append(words)))
        while len(begun) < 2:
            await asyncio.sleep(0.01)
        pid = proof.pid
        assert pid is not None
        assert await proof.prove(QUICK, told) == Failed("a proof is running: wait for it, or cancel it")
        proof.cancel()
        assert await task == Failed(CANCELLED)
        wait_for_end(pid)
        assert proof.pid is None

    asyncio.run(main())


def test_a_killed_proof_is_said() -> None:
    async def main() -> None:
        proof = ProofRun()
        task = asyncio.ensure_future(proof.prove(QUICK, told))
        while proof.pid is None:
            await asyncio.sleep(0.01)
        os.kill(proof.pid, signal.SIGKILL)
        assert await task == Failed("The proof stopped (killed by signal 9): try again.")

    asyncio.run(main())


def test_others_wait_while_two_are_proved() -> None:
    async def main() -> None:
        runs = [ProofRun() for _ in range(3)]
        heard: list[str] = []
        tasks = [asyncio.ensure_future(one.prove(QUICK, told)) for one in runs[:2]]
        tasks.append(asyncio.ensure_future(runs[2].prove(QUICK, lambda _, words: heard.append(words))))
        while "waiting for another proof to end" not in heard:
            await asyncio.sleep(0.01)
        assert runs[2].pid is None
        for one in runs:
            one.cancel()
        assert await asyncio.gather(*tasks) == [Failed(CANCELLED)] * 3

    asyncio.run(main())


def test_what_cannot_be_proved_is_one_line() -> None:
    failed = asyncio.run(ProofRun().prove(replace(QUICK, scene="nowhere"), told))
    assert isinstance(failed, Failed)
    assert failed.text.startswith("unknown scene 'nowhere'")
    assert "\n" not in failed.text
    with pytest.raises(RigsimError, match="points 0"):
        prove_here(replace(QUICK, points=0), told)
