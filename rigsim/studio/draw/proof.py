"""The three witnesses for one rig, called in a process of its own that can be cancelled."""

from __future__ import annotations

import asyncio
import math
import shlex
import threading
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any, ClassVar, TypeAlias

from rigsim.errors import RigsimError
from rigsim.rig.stereo import StereoRig
from rigsim.studio.draw.child import Child, begin, receive, send
from rigsim.studio.draw.request import Failed

Progress: TypeAlias = Callable[[float, str], None]
"""Is told the share that is done, 0 to 1, and what is being done."""

CANCELLED = "Cancelled: nothing was proved."
"""What a cancelled proof says."""

_AT_ONCE = 2  # each takes a processor and half a gigabyte
_LOOK_S = 0.2


@dataclass(frozen=True, slots=True)
class ProofRequest:
    """A rig that is to be predicted, simulated and measured."""

    rig: StereoRig
    """The rig."""
    scene: str = "boards"
    """A bundled scene's name, or the path of an MJCF file."""
    noise_px: float = 0.25
    """Standard deviation of one pixel coordinate, px."""
    points: int = 1000
    """Truth points."""
    seed: int = 0
    """Seed of every random number."""
    trials: int = 100
    """Noisy repetitions of each point."""
    measure: str = "auto"
    """What is measured in the pictures: auto, none, corners, patches or dense."""

    @property
    def command(self) -> str:
        """The command line that gives the same, where rig.toml is the rig."""
        words = [
            "rigsim",
            "sweep",
            "--rig",
            "rig.toml",
            "--scene",
            self.scene,
            "--noise",
            f"{self.noise_px:.15g}",
        ]
        words += ["--points", str(self.points), "--trials", str(self.trials), "--seed", str(self.seed)]
        words += [] if self.measure == "auto" else ["--measure", self.measure]
        return shlex.join(words)


@dataclass(frozen=True, slots=True)
class ProofRow:
    """What the witnesses say of all points, or of those in a bin of depth; None where one says nothing."""

    near_mm: float | None
    """Near edge of the bin, mm; None for all points."""
    far_mm: float | None
    """Far edge of the bin, mm; None for all points."""
    depth_mm: float | None
    """Median depth of the points, mm."""
    predicted_mm: float | None
    """Predicted root mean square depth error, mm."""
    simulated_mm: float | None
    """Simulated root mean square depth error, mm."""
    measured_mm: float | None
    """Root mean square depth error measured in the pictures, mm."""
    measured_predicted_mm: float | None
    """What the measurement's own error estimate predicts for it, mm: its pixels are not as noisy as the
    simulation's."""
    measured_n: int
    """Measured points."""
    agreement: str
    """``agrees``, or ``flagged`` or ``untold`` with the reason."""


@dataclass(frozen=True, slots=True)
class ProvedRig:
    """What the three witnesses say of a rig."""

    request: ProofRequest
    """What was asked."""
    whole: ProofRow
    """All points."""
    bins: tuple[ProofRow, ...]
    """Bins of depth, near to far."""
    headline: str
    """The answer in one sentence."""
    verdict: tuple[str, ...]
    """What else must be known, a sentence each."""
    agrees: bool
    """Whether nothing is flagged."""
    scene: str
    """The scene's name."""
    method: str
    """What was measured in the pictures: corners, patches, dense, or none."""
    remarks: tuple[str, ...]
    """What is odd about the scene or the rig's place in it."""
    command: str
    """The command line that gives the same, where rig.toml is `rig_toml`."""
    report: bytes
    """The report, an HTML page that needs no other file."""
    rig_toml: bytes
    """The rig, as a file that `command` reads."""


class ProofRun:
    """Proves one rig at a time, in a process of its own."""

    _running: ClassVar[set[ProofRun]] = set()

    def __init__(self) -> None:
        """Begin without a process."""
        self._child: Child | None = None
        self._cancelled = False

    @property
    def pid(self) -> int | None:
        """Process id of the proof; None while there is none."""
        return None if self._child is None else self._child.pid

    async def prove(self, request: ProofRequest, progress: Progress) -> ProvedRig | Failed:
        """Predict, simulate and measure; a few proofs run at once, others wait.

        Args:
            request: the rig, and with how many points.
            progress: is told the share that is done and what is being done, in this loop.
        """
        if self in self._running:
            return Failed("a proof is running: wait for it, or cancel it")
        self._cancelled = False
        while len(self._running) >= _AT_ONCE:
            progress(0.0, "waiting for another proof to end")
            await asyncio.sleep(_LOOK_S)
            if self._cancelled:
                return Failed(CANCELLED)
        self._running.add(self)
        try:
            return await self._proved(request, progress)
        finally:
            self._running.discard(self)

    def cancel(self) -> None:
        """End the proof that runs, if one does; it says `CANCELLED`."""
        self._cancelled = True
        if self._child is not None:
            self._child.end()

    async def _proved(self, request: ProofRequest, progress: Progress) -> ProvedRig | Failed:
        progress(0.0, "starting")
        child = self._child = Child(main)
        heard: asyncio.Queue[Any] = asyncio.Queue()
        listener = (child, asyncio.get_running_loop(), heard)
        threading.Thread(target=_listen, args=listener, name="rigsim proof", daemon=True).start()
        try:
            child.send(request)
            while True:
                message = await heard.get()
                if isinstance(message, ProvedRig | Failed):
                    return message
                if message is None:
                    break
                progress(*message)
            how = child.how_it_ended()
        except OSError:
            how = child.how_it_ended()
        finally:
            self._child = None
            child.end()
        return Failed(CANCELLED if self._cancelled else f"The proof stopped ({how}): try again.")


def _listen(child: Child, loop: asyncio.AbstractEventLoop, heard: asyncio.Queue[Any]) -> None:
    """Hand on what the process says; None when it has ended."""
    message: object = ""
    while message is not None:
        try:
            message = child.receive()
        except (EOFError, OSError):
            message = None
        try:
            loop.call_soon_threadsafe(heard.put_nowait, message)
        except RuntimeError:
            return  # the loop has been closed
    child.close()


def main(connection: Connection) -> None:
    """The process: one proof."""
    begin()
    try:
        request = receive(connection)

        def progress(share: float, words: str) -> None:
            send(connection, (share, words))

        send(connection, _answer(request, progress))
        receive(connection)  # the other end says when it has read all
    except (EOFError, OSError):
        return


def _answer(request: ProofRequest, progress: Progress) -> ProvedRig | Failed:
    try:
        return prove_here(request, progress)
    except RigsimError as error:
        return Failed(" ".join(str(error).split()))
    except Exception as error:  # the page goes on, and the terminal says what is wrong
        traceback.print_exc()
        return Failed(f"this rig cannot be proved: {type(error).__name__}: {error}")


def prove_here(request: ProofRequest, progress: Progress) -> ProvedRig:
    """Predict, simulate and measure in this process.

    Raises:
        RigsimError: as `rigsim.sweep`.
    """
    import rigsim

    progress(0.1, f"drawing, simulating and measuring in {request.scene}")
    found = rigsim.sweep(
        rig=request.rig,
        scene=request.scene,
        noises_px=request.noise_px,
        points=request.points,
        trials=request.trials,
        measure=request.measure,
        seed=request.seed,
        command=request.command,
    )
    progress(0.7, "writing the report")
    document, files, verdict = found.document(), found.files(), found.verdict
    row = document["rows"][0]
    return ProvedRig(
        request=request,
        whole=_row(row),
        bins=tuple(_row(part) for part in document["by_depth"]),
        headline=verdict.headline,
        verdict=verdict.sentences,
        agrees=verdict.agrees,
        scene=row["scene"],
        method=row["measured_method"],
        remarks=tuple(remark.text for remark in found.remarks),
        command=request.command,
        report=files["report.html"],
        rig_toml=files["rig.toml"],
    )


def _row(row: Mapping[str, Any]) -> ProofRow:
    """One row of the sweep's document; docs/reference/columns.md says what its keys mean."""
    return ProofRow(
        near_mm=_known(row.get("depth_near_mm")),
        far_mm=_known(row.get("depth_far_mm")),
        depth_mm=_known(row["depth_median_mm"]),
        predicted_mm=_known(row["predicted_depth_rmse_mm"]),
        simulated_mm=_known(row["depth_rmse_mm"]),
        measured_mm=_known(row["measured_depth_rmse_mm"]),
        measured_predicted_mm=_known(row["predicted_from_measured_rmse_mm"]),
        measured_n=int(_known(row["measured_n"]) or 0),
        agreement=str(row["agreement"]),
    )


def _known(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else None
