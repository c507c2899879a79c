"""What names mean: `K1`, `cameraMatrix1`, `left.camera_matrix` and `LEFT_K` are one thing.

A name is cut into words; one of them tells the camera, the others what it is.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from rigsim.errors import InvalidRig
from rigsim.interop.formats.opencv.filestorage import storage_table
from rigsim.interop.formats.yaml_text import TWICE, opencv_matrix

_ROLES = {
    "K": "k m cm kk cameramatrix cammatrix cameramat cammat cameramtx camerak matrix mtx intrinsic intrinsics"
    " intrinsicmatrix intrinsicsmatrix cameraintrinsic cameraintrinsics cameraintrinsicmatrix kmatrix kmat",
    "D": "d dc kc dist distcoeff distcoeffs distcoef distcoefs distortion distortioncoefficient coeffs coefs"
    " distortioncoefficients distortioncoeff distortioncoeffs distortioncoefs distortionvector distortionvec"
    " distortionparameters distortionparams distparams distvec cameradistortion distortionmatrix",
    "R": "r rot rotation rotationmatrix rotationmat rotationmtx rmat rmtx rmatrix rotmat rotmtx rotmatrix",
    "T": "t tr trans translation translationvector translationvec translationmatrix translationmat"
    " transvector transvec tvec tvector tra",
    "rvec": "om rvec rodrigues rotvec rotationvector rvector",
    "xi": "xi",
    "P": "p proj projection projectionmatrix projmat pmat pmatrix",
    "Q": "q qmat qmatrix disparitytodepth disparitytodepthmatrix disptodepth reprojection reprojectionmatrix"
    " disparitytodepthmappingmatrix",
    "rect": "rect rectification rectificationmatrix rectificationrotation rectificationtransform rrect rectr"
    " rectrotation rectmatrix",
    "width": "width imagewidth imgwidth imwidth framewidth",
    "height": "height imageheight imgheight imheight frameheight",
    "size": "size imagesize imgsize imsize framesize resolution imageresolution",
    "shape": "shape imageshape imgshape",
    "roi": "roi validroi validpixroi",
    "model": "model distortionmodel cameramodel lensmodel projectionmodel cameratype distortiontype",
    "unit": "unit units lengthunit lengthunits translationunit translationunits tunit tunits",
    "fisheye": "fisheye isfisheye usefisheye fisheyemodel isfisheyecamera",
}  # fmt: skip
LENGTH_UNITS: Mapping[str, str] = MappingProxyType(
    {
        "mm": "mm millimeter millimeters millimetre millimetres",
        "cm": "cm centimeter centimeters centimetre centimetres",
        "m": "m meter meters metre metres",
    }
)
"""Units that may end the name of a length, and their words."""
_LENGTHS = {
    "baseline": "baseline baselinelength baselinedistance",
    "square": "squaresize squarelength squarewidth squareside squaresidelength boardsquaresize patternspacing"
    " chessboardsquaresize checkerboardsquaresize chesssquaresize",
}
_LENGTH_OF = {name: role for role, names in _LENGTHS.items() for name in names.split()} | {
    f"{name}{word}": f"{role}_{unit}"
    for role, names in _LENGTHS.items()
    for name in names.split()
    for unit, words in LENGTH_UNITS.items()
    for word in words.split()
}
_ROLE_OF = {name: role for role, names in _ROLES.items() for name in names.split()} | _LENGTH_OF
_LENGTH_ROLES = frozenset(_LENGTH_OF.values())
_OF_BOTH = frozenset(("R", "T", "rvec", "Q", "unit", *_LENGTH_ROLES))
"""What is of no camera even in the file of one."""
_FILLING = (
    frozenset(("camera", "cam", "cameras", "stereo", "calib", "calibration", "params", "parameters", "data")),
    frozenset(["intrinsic", "intrinsics", "extrinsic", "extrinsics", "fisheye", "pinhole"]),
)
"""Words that tell nothing: left out where the rest then has a meaning, the first ones first."""
_TERM = re.compile(r"fx|fy|cx|cy|k[1-6]|p[12]|xi", re.IGNORECASE)
_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_ONE_LETTER_EACH = re.compile(r"[kmdpr][lr]")
_MATRICES = frozenset(("K", "D", "R", "T", "rvec", "P", "Q", "rect", "roi", "size", "shape"))
_MOST_CAMERAS = 8


@dataclass(frozen=True, slots=True)
class Facts:
    """What files say: by role and side (``left``, ``right``, or empty) the key and the value."""

    values: Mapping[tuple[str, str], tuple[str, object]]
    fisheye: bool = False
    """Whether a key or a word says that the lenses are fisheyes."""
    unused: tuple[str, ...] = ()
    """Names, without those of the tables around them, of lists that mean nothing here."""

    def has(self, role: str, side: str = "") -> bool:
        """Whether there is such a value."""
        return (role, side) in self.values

    def value(self, role: str, side: str = "") -> object:
        """The value; None where there is none."""
        return self.values.get((role, side), ("", None))[1]

    def key(self, role: str, side: str = "") -> str:
        """What the file calls it."""
        return self.values[role, side][0]

    def has_camera(self, side: str = "") -> bool:
        """Whether a camera's matrix is there, or its four numbers."""
        return self.has("K", side) or all(self.has(term, side) for term in ("fx", "fy", "cx", "cy"))

    @property
    def has_cameras(self) -> bool:
        """Whether both cameras' matrices are there."""
        return self.has_camera("left") and self.has_camera("right")

    @property
    def has_pose(self) -> bool:
        """Whether the way from camera to camera is there, as R and T or as turns that rectify and P or Q."""
        if self.has("T") and (self.has("R") or self.has("rvec")):
            return True
        if self.has("T", "right") and self.has("R", "right"):
            return True
        turned = all(self.has("rect", side) or self.has("R", side) for side in ("left", "right"))
        return turned and (self.has("Q") or self.has_projections)

    @property
    def has_projections(self) -> bool:
        """Whether both rectified projections are there."""
        return self.has("P", "left") and self.has("P", "right")

    def of_side(self, side: str) -> Facts:
        """The same facts where what is of no side is of `side`."""
        moved = {(role, own or side): item for (role, own), item in self.values.items()}
        kept = {key: item for key, item in self.values.items() if key[0] in _OF_BOTH}
        return Facts(MappingProxyType({**moved, **kept}), self.fisheye, self.unused)

    def with_(self, other: Facts) -> Facts:
        """These facts, and those of `other` that are not among them."""
        return Facts(MappingProxyType({**other.values, **self.values}), self.fisheye or other.fisheye)


@functools.lru_cache(maxsize=64)
def facts_of(text: str) -> Facts:
    """What a file's text says.

    Raises:
        InvalidRig: it holds no table.
    """
    found: dict[tuple[str, str], tuple[str, object]] = {}
    unused: dict[str, None] = {}
    fisheye = False
    entries = [(path, _words(path, value), value) for path, value in _flat(storage_table(text), ())]
    zero_based = any("0" in words for _, (role, words), _ in entries if role in ("K", "P", "fx"))
    for path, (role, words), value in entries:
        fisheye = fisheye or _says_fisheye(role, path, value)
        side = _side(words, zero_based)
        if role is None or side is None:
            if isinstance(value, list) and value:
                unused.setdefault(path[-1])
            continue
        key = ".".join(path)
        known = found.get((role, side))
        if known is None or len(key) < len(known[0]):
            found[role, side] = (key, value)
    return Facts(MappingProxyType(found), fisheye, tuple(unused))


def sides_of_files(paths: Sequence[Path]) -> dict[Path, str]:
    """Which camera each file's name tells of: ``left``, ``right``, or empty."""
    found = {path: _split([word.lower() for word in _WORDS.findall(path.stem)]) for path in paths}
    words = {path: split[1] if split else [] for path, split in found.items()}
    zero_based = any("0" in own for own in words.values())
    return {path: _side(own, zero_based) or "" for path, own in words.items()}


def _flat(table: Mapping[str, object], path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], object]]:
    """The values of a table and of those in it, each with its names from the outermost on."""
    for name, value in table.items():
        own = (*path, str(name))
        if isinstance(value, Mapping):
            if "data" in value and ({"rows", "cols"} <= set(value) or "sizes" in value):
                yield own, opencv_matrix(dict(value), ".".join(own))
            else:
                yield from _flat(value, own)
        elif isinstance(value, list) and 0 < len(value) <= _MOST_CAMERAS and _all_tables(value):
            yield from _flat({str(i): item for i, item in enumerate(value)}, own)
        else:
            yield own, value


def _all_tables(values: Sequence[object]) -> bool:
    return all(isinstance(item, Mapping) for item in values)


def _words(path: tuple[str, ...], value: object) -> tuple[str | None, list[str]]:
    """The role of a value, and the words of its name that tell its camera."""
    scalar = isinstance(value, int | float | str)
    plain = [word for part in path for word in re.split(r"[^A-Za-z0-9]+", part) if word]
    terms = [word for word in plain if _TERM.fullmatch(word)]
    if scalar and terms:  # k1 is a coefficient where it is a number, and a matrix where it is a list
        plain.remove(terms[-1])
        found = _split([word.lower() for text in plain for word in _WORDS.findall(text)])
        return terms[-1].lower(), [] if found is None else found[1]
    found = _split([word.lower() for text in plain for word in _WORDS.findall(text)], of_matrix=True)
    if found is None:
        return None, []
    rest, sides = found
    role = _role(rest)
    if role in _MATRICES and not (isinstance(value, list) or value is TWICE):
        role = "size" if role == "size" and isinstance(value, str) else None
    if role in _LENGTH_ROLES and not isinstance(value, int | float):
        role = None
    if role == "K" and isinstance(value, list) and len(value) == 4:
        role = None  # fx, fy, cx, cy, or others' models
    return role, sides


def _split(words: list[str], *, of_matrix: bool = False) -> tuple[list[str], list[str]] | None:
    """The words that tell what it is, and those that tell which camera; None for a pose of the left camera in
    the right one's frame, the wrong way round for a rig."""
    if len(words) == 1 and _ONE_LETTER_EACH.fullmatch(words[0]):
        words = list(words[0])
    joined = " ".join(words)
    if "left" in words and "right" in words:
        for order in ("left to right", "right from left"):
            if order in joined:
                return joined.replace(order, "").split(), []
        return None
    for sides in (("left", "right"), ("0", "1", "2")):
        own = next((word for word in reversed(words) if word in sides), None)
        if own is not None:
            rest = list(words)
            rest.remove(own)
            return rest, [own]
    for place in reversed(range(len(words))):
        rest = [word for i, word in enumerate(words) if i != place]
        if words[place] in ("l", "r") and (not of_matrix or _role(rest) is not None):
            return rest, [words[place]]
    return words, []


def _side(words: Sequence[str], zero_based: bool) -> str | None:
    """``left``, ``right``, empty where no word tells, None where it is a third camera's."""
    if not words:
        return ""
    (word,) = words
    if word.isdigit():
        return {0: "left", 1: "right"}.get(int(word) - (0 if zero_based else 1))
    return "left" if word[0] == "l" else "right"


def _role(words: Sequence[str]) -> str | None:
    for filling in (frozenset[str](), _FILLING[0], _FILLING[0] | _FILLING[1]):
        role = _ROLE_OF.get("".join(word for word in words if word not in filling))
        if role is not None:
            return role
    return None


def _says_fisheye(role: str | None, path: tuple[str, ...], value: object) -> bool:
    if role == "model":
        word = str(value).lower()
        return any(part in word for part in ("fisheye", "equi", "kannala"))
    if role == "fisheye":
        return str(value).lower() in ("1", "true", "yes", "on", "1.0")
    return isinstance(value, list) and "fisheye" in ".".join(path).lower()


def check_twice(facts: Facts) -> None:
    """Refuse what was given twice, differently.

    Raises:
        InvalidRig: something was.
    """
    for key, value in facts.values.values():
        if value is TWICE:
            raise InvalidRig(f"{key} is given twice, differently: remove one")
