"""Which configurations a sweep runs, and the random stream of each."""

from __future__ import annotations

import hashlib
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.pixels.dense.views import RowView, view_of
from rigsim.rig import extent, given
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise, as_noise
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import SUPERSAMPLE
from rigsim.study.scene.axes import registry
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.recipe import Recipe
from rigsim.study.tolerance.joint.cause import CalibrationTolerance

Held: TypeAlias = Literal["", "focal", "lens"]
"""What stays between resolutions: the focal length in pixels or the lens; empty when there is but one."""

Triangulator: TypeAlias = str | Callable[[StereoRig, Array, Array], Array]

MEASURES = ("auto", "none", "corners", "patches", "dense")
"""What may be measured in the pictures."""

SUPERSAMPLES = (1, 2, 4)
"""Samples along each side of a pixel that may be asked for."""


@dataclass(frozen=True, slots=True)
class RigGrid:
    """A rig and the values its parameters take; the axes multiply. An empty axis leaves the rig's own value.

    With `focals_px` the field of view changes with the resolution; otherwise the lens stays, and
    more pixels mean a longer focal length in px.

    Example:
        >>> import rigsim
        >>> grid = rigsim.RigGrid(rigsim.preset("bin").rig, baselines_m=[0.05, 0.1], vergences_deg=[0, 2, 4])
        >>> len(grid)
        6
    """

    base: StereoRig
    """The rig that is varied."""
    baselines_m: Sequence[float] = ()
    """Distances between the cameras, m."""
    focals_px: Sequence[float] = ()
    """Focal lengths, px; excludes `hfovs_deg`."""
    hfovs_deg: Sequence[float] = ()
    """Horizontal fields of view, deg; excludes `focals_px`."""
    resolutions_px: Sequence[tuple[int, int]] = ()
    """(width, height), px."""
    vergences_deg: Sequence[float] = ()
    """Toe-in angles, deg."""
    more: Mapping[str, Sequence[float]] = field(default_factory=dict)
    """Values of the other axes of `rigsim.study.scene.axes.registry` that change the rig, by name."""

    def __post_init__(self) -> None:
        given.a(StereoRig, self.base, "a StereoRig: the rig that is varied")
        for axis in ("baselines_m", "focals_px", "hfovs_deg", "vergences_deg"):
            object.__setattr__(self, axis, given.reals(getattr(self, axis), axis))
        more = {name: given.reals(values, name) for name, values in self.more.items()}
        object.__setattr__(self, "more", more)
        for name in more:
            if name not in registry.BY_NAME or registry.BY_NAME[name] not in registry.OF_RIG:
                raise InvalidRange(f"axis {name!r}: must be one of {', '.join(registry.BY_NAME)}")
        object.__setattr__(self, "resolutions_px", sizes(self.resolutions_px))
        if self.focals_px and self.hfovs_deg:
            raise InvalidRange("--focal and --hfov both given: they say the same thing, give one")

    def __len__(self) -> int:
        return math.prod(max(len(self.values_of(axis)), 1) for axis in registry.OF_RIG)

    def __iter__(self) -> Iterator[StereoRig]:
        for values in itertools.product(*(self.values_of(axis) or (None,) for axis in registry.OF_RIG)):
            recipe = Recipe(self.base, self.base.left, self.base.right)
            for axis, value in zip(registry.OF_RIG, values, strict=True):
                if value is not None and axis.of_rig is not None:
                    recipe = axis.of_rig(recipe, value)
            yield recipe.rig()

    def values_of(self, axis: Axis) -> Sequence[Any]:
        """The values that an axis takes; none leaves the rig's own."""
        values: Sequence[Any] = getattr(self, axis.field) if axis.field else self.more.get(axis.name, ())
        return values

    @property
    def lens_held(self) -> Held:
        """What stays between resolutions."""
        if len(self.resolutions_px) < 2:
            return ""
        return "focal" if self.focals_px else "lens"


def sizes(given_sizes: object) -> tuple[tuple[int, int], ...]:
    """Sizes (width, height) in px: one, or several."""
    asked = given.several(given_sizes)
    if len(asked) == 2 and not any(np.ndim(np.asarray(side, object)) for side in asked):
        asked = (asked,)
    found = []
    for size in asked:
        sides = given.reals(size, "resolution")
        if len(sides) != 2 or not all(side.is_integer() for side in sides):
            raise InvalidRange(f"resolution {given.shown(size)}: must be (width, height), whole px")
        found.append((int(sides[0]), int(sides[1])))
    return tuple(found)


DEFAULT_SCENE = "boards"
"""The scene of a sweep unless another one is asked for."""


@dataclass(frozen=True, slots=True)
class Plan:
    """All that decides the numbers of a sweep.

    Example:
        >>> import rigsim
        >>> plan = rigsim.Plan(scene="bin", noises=[0.1, 0.5], range_m=(0.5, 2))
        >>> [noise.std_px for noise in plan.noises], plan.n_trials
        ([0.1, 0.5], 100)
    """

    scene: str = DEFAULT_SCENE
    """Bundled scene's name or path of an MJCF file."""
    mount: str | None = None
    """Where the rig sits; None for the scene's own."""
    noises: tuple[PixelNoise, ...] = (PixelNoise(0.25),)
    """Noise of the simulated pixel positions."""
    triangulators: tuple[Triangulator, ...] = ("optimal",)
    """Methods under test: names, ``package.module:function``, or functions."""
    range_m: tuple[float, float] | None = None
    """Nearest and farthest depth of the truth points, m; None for all that is seen, up to `far_limit_m`."""
    n_points: int = 2000
    """Truth points of one rig."""
    n_trials: int = 100
    """Noisy repetitions for each point."""
    seed: int = 0
    """Seed of every random stream."""
    renderer: str = "auto"
    """auto, egl, osmesa or rays."""
    measure: str = "auto"
    """What is measured in the pictures: none, corners, patches or dense; "auto" takes corners where the
    scene has boards, else patches; and nothing from the plain pictures of rays."""
    rectify: RowView | None = None
    """What a pair that is not rectified is turned into before patches or dense disparities are looked for:
    perspective, cylinder or latlong; None finds the plainest that holds what the cameras see."""
    sensors: Mapping[str, Sensor] = field(default_factory=lambda: {"ideal": Sensor()})
    """Lens and sensor that the pictures are taken with, by the name they have in tables."""
    supersample: int = SUPERSAMPLE
    """Samples along each side of a drawn pixel: 1, 2 or 4."""
    far_limit_m: float = math.inf
    """Farthest depth of the truth points without a `range_m`, m; `sweep` finds it."""
    assumed: StereoRig | None = None
    """The rig that triangulates, where it is another than the one that is swept, which projects; None for
    the same."""
    perturbation: Perturbation | None = None
    """How each built rig, which projects, differs from the one that is swept, which is assumed and
    triangulates; excludes `assumed`."""
    calibration: CalibrationTolerance | None = None
    """What the calibration of the rig that is swept leaves: every trial is triangulated with another one.
    Excludes `assumed` and `perturbation`, and goes with one rig."""
    timeout_s: float | None = None
    """How long one call of a ``package.module:function`` may take; it then runs in a process of its own. None
    runs it in this one."""
    asked: tuple[str, ...] = ()
    """Columns of the axes that were asked for and move others with them, or say the same as another in other
    words: tables and pictures follow them."""
    extra: dict[str, object] = field(default_factory=dict, compare=False)
    """What the caller wants written into the provenance."""

    def __post_init__(self) -> None:
        self._take()
        extent.SWEEP_POINTS.check(self.n_points)
        extent.TRIALS.check(self.n_trials)
        extent.TRIANGULATIONS.check(self.n_points * self.n_trials)
        if self.seed < 0:
            raise InvalidRange(f"seed {self.seed}: must be >= 0")
        if not self.noises or not self.triangulators or not self.sensors:
            raise InvalidRange("a sweep needs at least one noise level, one triangulator and one sensor")
        extent.NOISES.check(len(self.noises))
        view_of(self.rectify)
        if self.measure not in MEASURES:
            raise InvalidRange(f"measure {self.measure!r}: choose one of {', '.join(MEASURES)}")
        if self.assumed is not None and self.perturbation is not None:
            raise InvalidRange(
                "an assumed rig and a perturbation both given: they say the same thing, give one"
            )
        if self.calibration is not None and (self.assumed is not None or self.perturbation is not None):
            raise InvalidRange(
                f"{self.calibration.name} and an assumed rig or a perturbation both given: each says how the"
                " rig that triangulates is off, give one"
            )
        if self.timeout_s is not None and not self.timeout_s > 0:
            raise InvalidRange(f"timeout {self.timeout_s:g} s: must be > 0")
        if self.supersample not in SUPERSAMPLES:
            raise InvalidRange(f"supersample {self.supersample}: must be 1, 2 or 4")
        if self.range_m is not None:
            near, far = self.range_m
            if not (math.isfinite(far) and 0 < near < far):
                raise InvalidRange(f"range {near:g}:{far:g} m: must be 0 < near < far")

    def _take(self) -> None:
        """One noise or triangulator for several, a path for a scene, whole numbers of any kind."""
        object.__setattr__(self, "scene", str(given.path(self.scene, "scene")))
        object.__setattr__(self, "noises", tuple(as_noise(noise) for noise in given.several(self.noises)))
        object.__setattr__(self, "triangulators", given.several(self.triangulators))
        for name in ("n_points", "n_trials", "seed", "supersample"):
            value = given.real(getattr(self, name), name.removeprefix("n_"))
            if not value.is_integer():
                raise InvalidRange(f"{name.removeprefix('n_')} {value:g}: must be a whole number")
            object.__setattr__(self, name, int(value))
        if not isinstance(self.sensors, Mapping):
            raise InvalidRange(
                f"sensors {given.shown(self.sensors)}: must be by name, as in {{'ideal': Sensor()}}"
            )
        if self.range_m is not None:
            ends = given.reals(self.range_m, "range")
            if len(ends) != 2:
                raise InvalidRange(f"range {given.shown(self.range_m)}: must be (near, far), m")
            object.__setattr__(self, "range_m", ends)

    def true_and_assumed(self, rig: StereoRig) -> tuple[StereoRig, StereoRig]:
        """For a rig that is swept, the one that projects and the one that triangulates.

        Raises:
            InvalidRig: their pictures have other sizes.
        """
        if self.perturbation is not None:
            return self.perturbation.apply(rig), rig
        if self.assumed is None:
            return rig, rig
        for side, true, assumed in (
            ("left", rig.left, self.assumed.left),
            ("right", rig.right, self.assumed.right),
        ):
            if (true.width, true.height) != (assumed.width, assumed.height):
                raise InvalidRig(
                    f"assumed rig: its {side} picture of {assumed.width}x{assumed.height} px must be as "
                    f"large as the true rig's, {true.width}x{true.height} px: calibrate these pictures"
                )
        return rig, self.assumed

    def stream(self, purpose: str, scene: str, rig: StereoRig, *more: object) -> np.random.Generator:
        """The random stream of one configuration: it depends on nothing else that is swept."""
        description = (purpose, scene, *_numbers(rig), self.range_m, self.n_points, *more)
        digest = hashlib.sha256(repr(description).encode()).digest()
        key = tuple(int.from_bytes(digest[i : i + 4], "little") for i in range(0, 16, 4))
        return np.random.Generator(np.random.SFC64(np.random.SeedSequence(self.seed, spawn_key=key)))


def _numbers(rig: StereoRig) -> Iterable[object]:
    for lens in (rig.left, rig.right):
        yield (lens.width, lens.height, lens.fx, lens.fy, lens.cx, lens.cy, repr(lens.lens))
    yield rig.right_from_left.R.ravel().tolist()
    yield rig.right_from_left.t.tolist()
