"""Every error rigsim raises on purpose.

::

    RigsimError
    ├── InvalidRig            a rig, lens or pose that cannot exist
    ├── InvalidNoise          a pixel noise that cannot exist
    ├── InvalidRange          a range, list or quantity that cannot be read
    ├── InvalidScene          a scene, preset or mount that cannot be used
    │   └── NothingSeen       the left camera sees nothing there
    ├── InvalidImage          a picture that cannot be measured
    ├── RenderUnavailable     no renderer of the kind asked for
    ├── RenderMismatch        the renderer disagrees with rays or with the rig
    ├── TriangulatorError     a triangulator that is unknown, raises, or returns the wrong thing
    │   └── TriangulatorTimeout   one that does not come back
    ├── CalibrationUndetermined   board pictures that leave a rig's numbers open
    ├── MeasurementFailed     nothing that was looked for was found in the pictures
    └── OutputError           a file or folder that cannot be read or written

A message gives the value, the bound and the way out, in one line:
``baseline 0 mm: must be > 0``.
"""

from __future__ import annotations

from typing import Literal, TypeAlias


class RigsimError(Exception):
    """Base of all errors a user can cause; the command line prints it as one line.

    Example:
        >>> import rigsim
        >>> try:
        ...     rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(640, 480, 500.0), -0.1)
        ... except rigsim.RigsimError as error:
        ...     print(error)
        baseline -100 mm: must be > 0
    """


class InvalidRig(RigsimError, ValueError):
    """A rig, lens or pose that cannot exist."""


class InvalidNoise(RigsimError, ValueError):
    """A pixel noise that cannot exist."""


class InvalidRange(RigsimError, ValueError):
    """A range, list or quantity that cannot be read."""


class InvalidScene(RigsimError, ValueError):
    """A scene, preset or mount that cannot be used."""


class NothingSeen(InvalidScene):
    """The left camera sees nothing (within the range asked for)."""


class InvalidImage(RigsimError, ValueError):
    """A picture that cannot be measured: wrong shape, black, saturated, or not of the rig's size."""


class RenderUnavailable(RigsimError, RuntimeError):
    """No renderer of the kind asked for works here."""


class RenderMismatch(RigsimError, RuntimeError):
    """The rendered depth or frustum disagrees with rays or with the rig."""


TriangulatorReason: TypeAlias = Literal[
    "unknown",
    "unloadable",
    "misused",
    "raised",
    "ended",
    "timed-out",
    "no-array",
    "wrong-shape",
    "wrong-type",
    "wrong-file",
    "nothing-found",
]
"""Why a triangulator gives no points: its name is unknown, it cannot be loaded, is given pixels or a rig that
it is not for, raised, ended its process or failed, took too long; returned what is no array, an array of
another shape or type, a file that cannot be read; or found nothing anywhere."""


class TriangulatorError(RigsimError, ValueError):
    """A triangulator that is unknown, raises, or returns the wrong thing."""

    def __init__(
        self, message: str, reason: TriangulatorReason = "misused", shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(message)
        self.reason: TriangulatorReason = reason
        """What went wrong."""
        self.shape = shape
        """The shape that came back, where that is what is wrong."""

    def __reduce__(self) -> tuple[type[TriangulatorError], tuple[str, TriangulatorReason, tuple[int, ...]]]:
        return type(self), (str(self), self.reason, self.shape)


class TriangulatorTimeout(TriangulatorError):
    """A triangulator that takes longer than it may."""

    def __init__(
        self, message: str, reason: TriangulatorReason = "timed-out", shape: tuple[int, ...] = ()
    ) -> None:
        super().__init__(message, reason, shape)


class MeasurementFailed(RigsimError, RuntimeError):
    """Nothing that was looked for was found in the pictures, or what looks for it is not installed."""


CalibrationReason: TypeAlias = Literal["no_poses", "one_pose", "one_camera", "no_tilt", "middle", "open"]
"""Why boards leave a rig open: none is seen, there is a single one, none is seen by both cameras, none is
turned away from the pictures' planes, all are in the middle of the pictures, or something else."""


class CalibrationUndetermined(RigsimError, ValueError):
    """Board pictures that leave some of a rig's numbers open."""

    def __init__(self, message: str, reason: CalibrationReason = "open") -> None:
        super().__init__(message)
        self.reason: CalibrationReason = reason
        """What is missing."""

    def __reduce__(self) -> tuple[type[CalibrationUndetermined], tuple[str, CalibrationReason]]:
        return type(self), (str(self), self.reason)


class OutputError(RigsimError, OSError):
    """A file or folder that cannot be read or written."""
