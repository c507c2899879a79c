"""Every lens model. A new one is a file here and a line below; projection, files and reports follow."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rigsim.rig.lens import distortion, double_sphere, eucm, fov, kannala_brandt, mei, rational
from rigsim.rig.lens.lens import Lens

ALL: tuple[type[Lens], ...] = (
    distortion.BrownConrady,
    rational.Rational,
    kannala_brandt.KannalaBrandt,
    mei.Mei,
    double_sphere.DoubleSphere,
    eucm.Eucm,
    fov.FieldOfView,
)
"""All lens models; the first is meant where a file names none."""

BY_NAME: Mapping[str, type[Lens]] = MappingProxyType({lens.model: lens for lens in ALL})
"""The same, as rig.toml's ``model`` calls them."""

DEFAULT = ALL[0].model
"""The model of a file that names none."""
