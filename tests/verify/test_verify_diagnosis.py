"""A diagnosis names the mistake, whatever kind of triangulator makes it, and says nothing of a right one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.subjects import triangulators
from benchmarks.subjects.triangulators import Calibration
from rigsim.errors import TriangulatorError, TriangulatorReason
from rigsim.present.verify.words import says
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.study.verify.case import Case
from rigsim.study.verify.diagnosis.diagnosis import diagnose
from rigsim.study.verify.geometries import Geometry
from rigsim.study.verify.result import Diagnosis
from rigsim.study.verify.runner import run_case, verify
from rigsim.study.verify.suite import stream, synthetic_cases
from rigsim.study.verify.synthetic import exact
from rigsim.theory.custom import TriangulatorFunction
from rigsim.theory.triangulation import METHODS
from tests.helpers.verify_results import telling

SOLVERS = {"linear": triangulators.solve_linear, "opencv": triangulators.solve_opencv}
BASES: dict[str, TriangulatorFunction] = {
    "linear": triangulators.linear,
    "midpoint": triangulators.midpoint,
    "opencv": triangulators.opencv,
}


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    # no noise: a mistake shows without it
    return list(telling())


def diagnosed(cases: Sequence[Case], function: TriangulatorFunction) -> tuple[Diagnosis, ...]:
    return diagnose([run_case(case, "one", function, 1e-6) for case in cases])


@dataclass(frozen=True)
class Believed:
    """A right triangulator that is given a wrong calibration."""

    base: str
    change: Callable[[Calibration, StereoRig], Calibration]

    def __call__(self, rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        changed = self.change(triangulators.calibration(rig), rig)
        return SOLVERS[self.base](changed, uv_left, uv_right)


def centre(K: Array, cx: float, cy: float) -> Array:
    moved = K.copy()
    moved[:2, 2] = cx, cy
    return moved


def both_moved(c: Calibration, px: float) -> Calibration:
    moved = [centre(K, K[0, 2] + px, K[1, 2] + px) for K in (c.K_left, c.K_right)]
    return replace(c, K_left=moved[0], K_right=moved[1])


def square(K: Array) -> Array:
    return np.array([[K[0, 0], 0, K[0, 2]], [0, K[0, 0], K[1, 2]], [0, 0, 1]])


def no_doffs(c: Calibration, rig: StereoRig) -> Calibration:
    return replace(c, K_right=centre(c.K_right, c.K_left[0, 2], c.K_right[1, 2])) if rig.is_rectified else c


def turned(c: Calibration, change: Callable[[Array], Array]) -> Calibration:
    return replace(c, R=Rotation.from_rotvec(change(Rotation.from_matrix(c.R).as_rotvec())).as_matrix())


def lenses(c: Calibration, change: Callable[[Array], Array]) -> Calibration:
    return replace(c, lens_left=change(c.lens_left), lens_right=change(c.lens_right))


BELIEFS: dict[str, Callable[[Calibration, StereoRig], Calibration]] = {
    "half-pixel": lambda c, rig: both_moved(c, 0.5),
    "pixels-from-one": lambda c, rig: both_moved(c, -1.0),
    "image-centre-for-principal-point": lambda c, rig: replace(
        c,
        K_left=centre(c.K_left, rig.left.width / 2, rig.left.height / 2),
        K_right=centre(c.K_right, rig.right.width / 2, rig.right.height / 2),
    ),
    "doffs-ignored": no_doffs,
    "fx-for-fy": lambda c, rig: replace(c, K_left=square(c.K_left), K_right=square(c.K_right)),
    "intrinsics-missing": lambda c, rig: replace(c, K_left=np.eye(3), K_right=np.eye(3)),
    "swapped-intrinsics": lambda c, rig: replace(
        c, K_left=c.K_right, K_right=c.K_left, lens_left=c.lens_right, lens_right=c.lens_left
    ),
    "left-intrinsics-for-both": lambda c, rig: replace(c, K_right=c.K_left),
    "right-intrinsics-for-both": lambda c, rig: replace(c, K_left=c.K_right, lens_left=c.lens_right),
    "transposed-rotation": lambda c, rig: replace(c, R=c.R.T.copy()),
    "inverse-pose": lambda c, rig: replace(c, R=c.R.T.copy(), t=-c.R.T @ c.t),
    "baseline-sign": lambda c, rig: replace(c, t=-c.t),
    "centre-for-translation": lambda c, rig: replace(c, t=-c.R.T @ c.t),
    "rotation-ignored": lambda c, rig: replace(c, R=np.eye(3)),
    "unit-baseline": lambda c, rig: replace(c, t=c.t / np.linalg.norm(c.t)),
    "baseline-along-x-only": lambda c, rig: replace(c, t=np.array([-np.linalg.norm(c.t), 0.0, 0.0])),
    "degrees-for-radians": lambda c, rig: turned(c, np.degrees),
    "distortion-ignored": lambda c, rig: lenses(c, np.zeros_like),
    "distortion-sign": lambda c, rig: lenses(c, np.negative),
    "distortion-p1-p2": lambda c, rig: lenses(c, lambda k: k[[0, 1, 3, 2, 4]]),
    "distortion-k3": lambda c, rig: lenses(c, lambda k: k * (1, 1, 1, 1, 0)),
    "distortion-order": lambda c, rig: lenses(c, lambda k: k[[0, 1, 4, 2, 3]]),
}


@pytest.mark.parametrize(("number", "mistake"), list(enumerate(BELIEFS)))
def test_a_wrong_calibration_is_named(cases: list[Case], number: int, mistake: str) -> None:
    base = list(SOLVERS)[number % 2]
    first, *_ = diagnosed(cases, Believed(base, BELIEFS[mistake]))
    assert first.mistake == mistake
    assert first.explained > 0.95
    assert first.cases


def flipped(uv: Array, height: int) -> Array:
    return np.column_stack([uv[:, 0], height - 1 - uv[:, 1]])


def sixteenths(uv_left: Array, uv_right: Array) -> Array:
    disparity = np.round(16 * (uv_left[:, 0] - uv_right[:, 0])) / 16
    return np.column_stack([uv_left[:, 0] - disparity, uv_right[:, 1]])


PIXELS: dict[str, Callable[[StereoRig, Array, Array], tuple[Array, Array]]] = {
    "swapped-images": lambda rig, left, right: (right, left),
    "row-column-exchanged": lambda rig, left, right: (left[:, ::-1], right[:, ::-1]),
    "flipped-v": lambda rig, left, right: (flipped(left, rig.left.height), flipped(right, rig.right.height)),
    "rounded-pixels": lambda rig, left, right: (np.round(left), np.round(right)),
    "rounded-disparity": lambda rig, left, right: (left, sixteenths(left, right)),
    "nan-answered": lambda rig, left, right: (np.nan_to_num(left), np.nan_to_num(right)),
    "pixel-offset": lambda rig, left, right: (left + np.array([0.3, 0.0]), right),
}


@pytest.mark.parametrize(("number", "mistake"), list(enumerate(PIXELS)))
def test_wrong_pixels_are_named(cases: list[Case], number: int, mistake: str) -> None:
    base = list(BASES)[number % 3]
    first, *_ = diagnosed(
        cases, lambda rig, left, right: BASES[base](rig, *PIXELS[mistake](rig, left, right))
    )
    assert first.mistake == mistake
    assert first.explained > 0.95


def rectified_frame(X: Array, rig: StereoRig) -> Array:
    c = triangulators.calibration(rig)
    R_left = cv2.stereoRectify(c.K_left, c.lens_left, c.K_right, c.lens_right, c.size, c.R, c.t[:, None])[0]
    return np.asarray(X @ R_left.T)


ANSWERS: dict[str, Callable[[Array, StereoRig], Array]] = {
    "millimetres": lambda X, rig: 1e3 * X,
    "scale": lambda X, rig: 1.013 * X,
    "right-frame": lambda X, rig: rig.right_from_left.apply(X),
    "rig-frame": lambda X, rig: rig.rig_from_left.apply(X),
    "rectified-frame": rectified_frame,
    "opengl-axes": lambda X, rig: X * (1, -1, -1),
    "flipped-y": lambda X, rig: X * (1, -1, 1),
    "x-y-exchanged": lambda X, rig: X[:, [1, 0, 2]],
    "ray-length-for-depth": lambda X, rig: np.column_stack([X[:, :2], np.linalg.norm(X, axis=1)]),
    "single-precision": lambda X, rig: X.astype(np.float32),
    "rounded-answers": lambda X, rig: np.round(X, 6),
    "rows-reordered": lambda X, rig: X[np.argsort(X[:, 2])],
    "rows-shifted": lambda X, rig: np.roll(X, 1, axis=0),
    "constant-answer": lambda X, rig: np.repeat(X[:1], len(X), axis=0),
    "disparity-clamped": lambda X, rig: X * np.minimum(1, 100 / X[:, 2:]),
    "far-points-missing": lambda X, rig: np.where(X[:, 2:] > 100, np.nan, X),
    "homogeneous-answer": lambda X, rig: X / np.sqrt(1 + np.sum(X**2, axis=1, keepdims=True)),
    "shrunk-depth": lambda X, rig: X / (0.97 + 0.005 * X[:, 2:]),
    "transposed-answer": lambda X, rig: X.T,
    "rows-dropped": lambda X, rig: X[np.isfinite(X).all(axis=1)],
    "depth-alone": lambda X, rig: X[:, 2],
}


@pytest.mark.parametrize("mistake", ANSWERS)
def test_wrong_answers_are_named(cases: list[Case], mistake: str) -> None:
    first, *_ = diagnosed(
        cases, lambda rig, left, right: ANSWERS[mistake](triangulators.midpoint(rig, left, right), rig)
    )
    assert first.mistake == mistake
    assert first.explained > 0.75


def test_a_rig_kept_from_the_first_call_is_named(cases: list[Case]) -> None:
    kept: list[StereoRig] = []

    def stale(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        kept.append(rig)
        return triangulators.linear(kept[0], uv_left, uv_right)

    assert diagnosed(cases, stale)[0].mistake == "stale-rig"


def test_undistortion_that_stops_at_opencvs_default_is_named(cases: list[Case]) -> None:
    def unfinished(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        c = triangulators.calibration(rig)
        if not (c.lens_left.any() and len(uv_left)):
            return triangulators.linear(rig, uv_left, uv_right)
        left, right = (
            cv2.undistortPoints(uv[:, None], K, lens)[:, 0]
            for uv, K, lens in ((uv_left, c.K_left, c.lens_left), (uv_right, c.K_right, c.lens_right))
        )
        return triangulators.intersect(c, left, right)

    first, *_ = diagnosed(cases, unfinished)
    assert first.mistake == "undistortion-unfinished"
    assert "5 fixed-point steps" in says(first)


def test_the_formula_of_rectified_rigs_is_named_where_it_does_not_hold(cases: list[Case]) -> None:
    def parallel(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        with np.errstate(all="ignore"):
            z = rig.left.fx * rig.baseline_m / (uv_left[:, 0] - uv_right[:, 0] + rig.doffs_px)
            xy = (uv_left - (rig.left.cx, rig.left.cy)) / (rig.left.fx, rig.left.fy)
            points = np.column_stack([xy * z[:, None], z])
        return np.where(z[:, None] > 0, points, np.nan)

    assert diagnosed(cases, parallel)[0].mistake == "treated-as-rectified"


@pytest.mark.parametrize("name", ["optimal", "dlt", "midpoint"])
def test_a_right_triangulator_has_no_diagnosis(cases: list[Case], name: str) -> None:
    assert diagnosed(cases, METHODS[name]) == ()


def test_two_mistakes_at_once_are_not_said_to_be_explained(cases: list[Case]) -> None:
    def muddled(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        points = triangulators.linear(rig, np.round(uv_left) + np.array([3.0, 7.0]), uv_right[:, ::-1])
        return np.asarray(points[:, [2, 0, 1]])

    first, *_ = diagnosed(cases, muddled)
    assert first.explained < 0.5
    assert "cases fail" in says(first)


def test_random_errors_are_called_so(cases: list[Case]) -> None:
    rng = np.random.default_rng(1)

    def shaken(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        points = triangulators.linear(rig, uv_left, uv_right)
        return np.asarray(points * (1 + 1e-4 * rng.standard_normal(points.shape)))

    first, *_ = diagnosed(cases, shaken)
    assert first.mistake == "random-errors"
    assert first.explained == 0.0


def test_what_only_noise_brings_out_is_called_inefficient() -> None:
    rng = np.random.default_rng(1)

    def wasteful(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        by = 0.8 if len(uv_left) > 1000 else 0.0
        return triangulators.linear(rig, uv_left + by * rng.standard_normal(uv_left.shape), uv_right)

    cases = [case for case in synthetic_cases("quick", 5) if case.group in ("verged", "nowhere")]
    assert diagnosed(cases, wasteful)[0].mistake == "inefficient"


def test_an_error_speaks_for_itself_and_the_other_cases_are_diagnosed_too(cases: list[Case]) -> None:
    def fragile(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        if len(uv_left) == 0:
            raise ValueError("nothing to do")
        return 1e3 * triangulators.linear(rig, uv_left, uv_right)

    found = {diagnosis.mistake: diagnosis for diagnosis in diagnosed(cases, fragile)}
    assert next(iter(found)) == "millimetres"
    alone = diagnosed([case for case in cases if len(case) == 0], fragile)
    assert alone[0].mistake == "raises"
    assert "nothing to do" in says(alone[0])


@pytest.mark.parametrize(
    ("words", "reason", "shape", "mistake"),
    [
        # words that a program's last words, or a name, may hold as well tell nothing
        ("program 'tri' failed with exit code 1: AssertionError raised", "ended", (), "broken"),
        ("program 'tri' failed with exit code 1: returned shape (3, 10)", "ended", (), "broken"),
        ("triangulator 'mine:raised_floor' returned type object", "wrong-type", (), "wrong-type"),
        ("triangulator 'returned type' says no", "raised", (), "raises"),
        ("no good", "wrong-shape", (3, 10), "transposed-answer"),
        ("no good", "wrong-shape", (10, 4), "homogeneous-answer"),
    ],
)
def test_what_an_error_is_is_asked_of_its_reason(
    words: str, reason: TriangulatorReason, shape: tuple[int, ...], mistake: str
) -> None:
    points = np.column_stack([np.zeros(10), np.zeros(10), np.linspace(1, 2, 10)])
    case = Case("ten", "ten", "exact", "", RECTIFIED, *RECTIFIED.project(points), points)

    def broken(*_: object) -> Array:
        raise TriangulatorError(words, reason, shape)

    assert diagnose([run_case(case, "one", broken, 1e-6)])[0].mistake == mistake


RECTIFIED = StereoRig.rectified(
    Intrinsics.from_focal(1000, 800, 800.0), 0.1, right=Intrinsics.from_focal(1000, 800, 800.0, cx=519.5)
)


def by_hand(rig: StereoRig, points: list[tuple[float, float, float]], answers: list[Array]) -> Diagnosis:
    """The diagnosis of answers that were computed by hand; f = 800 px, B = 0.1 m, f B = 80 px m."""
    truth = np.array(points)
    uv_left, uv_right = rig.project(truth)
    case = Case("by hand", "by hand", "exact", "", rig, uv_left, uv_right, truth)
    result = run_case(case, "one", lambda *_: np.array(answers), 1e-6)
    assert result.status() == "failed"
    return diagnose([result])[0]


POINTS = [(0.0, 0.0, 1.0), (0.1, 0.2, 2.0), (-0.3, 0.1, 4.0), (0.2, -0.4, 1.6)]


def test_doffs_by_hand() -> None:
    # Z = 1 m: u is 499.5 and 439.5, d 60 px and doffs 20 px; without them Z = 80 / 60
    assert RECTIFIED.doffs_px == 20.0
    points = [*POINTS[:2], (-0.3, 0.1, 3.2), POINTS[3]]
    first = by_hand(RECTIFIED, points, [np.array(p) * (80 / p[2]) / (80 / p[2] - 20) for p in points])
    assert first.mistake == "doffs-ignored"
    assert first.explained == pytest.approx(1.0, abs=1e-6)


def test_half_a_pixel_by_hand() -> None:
    # cx 0.5 px too large in both images: d, so Z, is right; x and y are Z / 1600 too small
    rig = replace(RECTIFIED, right=RECTIFIED.left)
    first = by_hand(rig, POINTS, [np.array([x - z / 1600, y - z / 1600, z]) for x, y, z in POINTS])
    assert first.mistake == "half-pixel"
    assert "0.5 px more" in says(first)
    # and only in the right image: d is 0.5 px larger
    closer = [np.array(p) * (80 / p[2]) / (80 / p[2] + 0.5) for p in POINTS]
    first = by_hand(rig, POINTS, closer)
    assert first.mistake == "half-pixel"
    assert "along u alone" in says(first)


def test_a_factor_by_hand() -> None:
    first = by_hand(RECTIFIED, POINTS, [np.array(p) * 25.0 for p in POINTS])
    assert first.mistake == "scale"
    assert " 25 times" in says(first)


def test_a_run_carries_its_diagnosis() -> None:
    geometry = Geometry("flat", RECTIFIED, (1.0, 3.0))
    case = exact(geometry, 50, stream(0, "flat"))
    runs = verify([case], {"right": METHODS["optimal"], "wrong": lambda rig, left, right: left})
    assert runs[0].diagnoses == ()
    assert [diagnosis.mistake for diagnosis in runs[1].diagnoses] == ["depth-missing"]


def test_cases_that_pass_refute(cases: list[Case]) -> None:
    """One wrong case alone leaves two explanations; a case that passes leaves one."""
    doffs, off_centre = (
        run_case(next(case for case in cases if case.name == name), "one", Believed("linear", no_doffs), 1e-6)
        for name in ("doffs exact", "off-centre exact")
    )
    other = "image-centre-for-principal-point"
    assert other in [diagnosis.mistake for diagnosis in diagnose([doffs])]
    assert diagnose([off_centre, doffs])[0].mistake == "doffs-ignored"
    assert other not in [diagnosis.mistake for diagnosis in diagnose([off_centre, doffs])]
