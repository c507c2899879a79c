"""`rigsim design`: from requirements to a rig, proved in a scene."""

from __future__ import annotations

import importlib.util
import json
import math
import re
import shlex
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rigsim.cli import quantity
from rigsim.errors import InvalidRange, InvalidRig

if TYPE_CHECKING:
    from rigsim.study.design import Design, Specification
    from rigsim.study.design_proof import Proof
    from rigsim.theory.inverse import Camera, Requirement

UNVERIFIED = 3
"""Exit code when the simulation does not confirm any rig tried."""

_PERCENT = re.compile(r"([0-9]*\.?[0-9]+)\s*%")
_UNIT = re.compile(r"[a-zA-Zµμ°%]\s*$")


def design(
    depth_range: Annotated[str, typer.Option("--range", metavar="NEAR:FAR", help="Working range: 0.5:3m.")],
    depth_error: Annotated[
        list[str],
        typer.Option(
            metavar="ERROR[@DISTANCE]",
            help="Depth error allowed, one standard deviation: 10mm@3m, 1%, 1%@2m; p95:20mm@3m for what "
            "95 of 100 errors stay under. At the far end unless said. May be given several times.",
        ),
    ],
    fov: Annotated[
        str | None, typer.Option(metavar="DEG", help="Horizontal field of view, at least.")
    ] = None,
    cover: Annotated[
        str | None, typer.Option(metavar="WIDTH[@DISTANCE]", help="Width both cameras see, at least: 2m@3m.")
    ] = None,
    noise: Annotated[str, typer.Option(help="Noise per pixel coordinate, px standard deviation.")] = "0.25",
    max_baseline: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Longest baseline: 150 (mm), 0.15m.")
    ] = None,
    resolution: Annotated[str | None, typer.Option(help="Image sizes to try: 640x480,1280x960.")] = None,
    sensor: Annotated[
        str | None, typer.Option(metavar="NAME,...", help="Sensors to try, instead; see `rigsim scenes`.")
    ] = None,
    lens: Annotated[
        str | None,
        typer.Option(help="Lenses to try: 2.8,4,6,8mm with --sensor; or 900,1200px, or 60,70deg."),
    ] = None,
    max_disparity: Annotated[
        str | None, typer.Option(metavar="PX", help="Disparities that the matcher searches.")
    ] = None,
    min_overlap: Annotated[
        str,
        typer.Option(metavar="%", help="Share of the left image that the right one sees at the near end."),
    ] = "50%",
    max_pixels: Annotated[
        str | None, typer.Option(metavar="MP", help="Most pixels of one image: 2MP.")
    ] = None,
    prefer: Annotated[
        str,
        typer.Option(help="smallest (baseline), cheapest (fewest pixels, then baseline) or most-accurate."),
    ] = "cheapest",
    scene: Annotated[
        str, typer.Option(help="Where the pick is proved: a bundled scene, or MJCF.")
    ] = "boards",
    no_proof: Annotated[
        bool, typer.Option("--no-proof", help="Formulas only: nothing is rendered or simulated.")
    ] = False,
    seed: Annotated[int, typer.Option(help="Seed of every random number.")] = 0,
    renderer: Annotated[str, typer.Option(help="auto, egl, osmesa or rays.")] = "auto",
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON document; files are written only with --out.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the report.", show_default="reports/design-TIME")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a report that is there.")] = False,
) -> None:
    """Find the rigs that meet requirements, recommend one, and prove it by simulation.

    Says which requirement binds at each end of the baselines allowed; when nothing is feasible, which one to
    relax and by how much. Exit code 3 when the simulation confirms none of the rigs tried.
    """
    near_mm, far_mm = _range(depth_range)
    near_m, far_m = near_mm / 1e3, far_mm / 1e3
    cameras = _cameras(resolution, sensor, lens, fov)

    from rigsim.study.design import solve, specify
    from rigsim.theory.inverse import Requirement

    asked = [_depth_error(text, far_m) for text in depth_error]
    if fov is not None:
        asked.append(Requirement("fov", math.radians(quantity.value(fov, quantity.HFOV))))
    if cover is not None:
        width, at_m = _at(cover, far_m, "cover")
        asked.append(Requirement("cover", _metres(width, "cover"), at_m))
    if max_baseline is not None:
        asked.append(Requirement("max_baseline", quantity.value(max_baseline, quantity.BASELINE) / 1e3))
    if max_disparity is not None:
        asked.append(Requirement("max_disparity", quantity.value(max_disparity, quantity.DISPARITY), near_m))
    if max_pixels is not None:
        asked.append(Requirement("pixels", _pixels(max_pixels)))
    specification = specify(
        near_m,
        far_m,
        asked,
        noise_px=quantity.value(noise, quantity.NOISE),
        min_overlap=_share(min_overlap),
    )
    found = solve(specification, cameras, prefer)

    from rigsim.interop import folder

    target = out or (None if as_json else Path("reports") / f"design-{time.strftime('%Y%m%d-%H%M%S')}")
    if target is not None:
        folder.check_output(target, force)
    proofs = () if no_proof else _prove(found, specification, scene, seed, renderer)
    _deliver(found, proofs, target, force, as_json)
    if proofs and not proofs[-1].verified:
        raise typer.Exit(UNVERIFIED)


def _prove(
    found: Design, specification: Specification, scene: str, seed: int, renderer: str
) -> tuple[Proof, ...]:
    from rigsim.cli.sensors import sensor_labels, sensors_from
    from rigsim.cli.sweep import TYPICAL_NOISE_GREY
    from rigsim.rig.noise import PixelNoise
    from rigsim.study.design_proof import prove
    from rigsim.study.plan import Plan

    measure = "auto"
    if importlib.util.find_spec("cv2") is None:
        measure = "none"
        typer.echo("OpenCV is not installed: nothing is measured (pip install 'rigsim[vision]')", err=True)
    sensors = sensors_from(image_noise=str(TYPICAL_NOISE_GREY))
    plan = Plan(
        scene=scene,
        noises=(PixelNoise(specification.noise_px),),
        range_m=(specification.near_m, specification.far_m),
        seed=seed,
        renderer=renderer,
        measure=measure,
        sensors=dict(zip(sensor_labels(sensors), sensors, strict=True)),
    )
    return prove(found, plan)


def _deliver(
    found: Design, proofs: tuple[Proof, ...], target: Path | None, force: bool, as_json: bool
) -> None:
    from rigsim.interop import folder
    from rigsim.interop.rig_toml import write_rig
    from rigsim.study.design_document import design_document, recommended

    document = design_document(found, proofs)
    command = shlex.join(["rigsim", *sys.argv[1:]])
    text = json.dumps(document, indent=2, ensure_ascii=False)
    if target is not None:
        from rigsim.present.design import design_html

        pick = recommended(found, proofs)
        files = {
            "rig.toml": write_rig(
                pick.rig, comment=f"rigsim design: {document['recommended']['reason']}"
            ).encode(),
            "design.json": (text + "\n").encode(),
            "design.html": design_html(found, proofs, command).encode(),
        }
        folder.write_folder(target, files, force)
    if as_json:
        typer.echo(text)
    else:
        from rigsim.present.design_console import print_design

        print_design(found, proofs, target)


def _range(text: str) -> tuple[float, float]:
    if not _UNIT.search(text):
        raise InvalidRange(f"range {text or 'empty'}: m or mm? Write the unit, as in 0.5:3m")
    if re.match(r"\s*0*\.?0*\s*(mm|cm|m)?\s*:", text) and text.strip()[:1] in "0.":
        raise InvalidRange(
            f"range {text}: starts at 0, where no two cameras see anything; start it farther off"
        )
    return quantity.span(text, quantity.DEPTH)


def _at(text: str, far_m: float, name: str) -> tuple[str, float]:
    """What stands before the @, and the distance after it, m; the far end without one."""
    what, at, where = text.partition("@")
    return what.strip(), _metres(where, f"{name} {text}, distance") if at else far_m


def _metres(text: str, name: str) -> float:
    if not _UNIT.search(text):
        raise InvalidRange(f"{name} {text.strip() or 'empty'}: of what? Write the unit, as in 10mm or 3m")
    kind = quantity.Kind(name, "mm", quantity.DEPTH.factors, above=0)
    return quantity.value(text.strip(), kind) / 1e3


def _depth_error(text: str, far_m: float) -> Requirement:
    from rigsim.theory.inverse import P95_OVER_STD, Requirement

    body, n_p95 = re.subn(r"\s*:?\bp95\b:?\s*", "", text.strip(), flags=re.IGNORECASE)
    what, at_m = _at(body, far_m, "depth error")
    per_std = P95_OVER_STD if n_p95 else 1.0
    match = _PERCENT.fullmatch(what)
    if match:
        share = float(match[1]) / 100
        if share > 1:
            raise InvalidRange(f"depth error {what}: must be <= 100 % of the distance")
        return Requirement("depth_error", share * at_m, at_m, per_std)
    if not _UNIT.search(what):
        raise InvalidRange(f"depth error {text}: mm or %? Write the unit, as in 10mm@3m or 1%")
    return Requirement("depth_error", _metres(what, "depth error"), at_m, per_std)


def _share(text: str) -> float:
    match = _PERCENT.fullmatch(text.strip())
    try:
        share = float(match[1]) / 100 if match else float(text)
    except ValueError:
        raise InvalidRange(f"min overlap {text or 'empty'}: must be a percentage, as in 80%") from None
    if not match and share > 1:
        raise InvalidRange(f"min overlap {text}: percent or share? Write {text}% or a number under 1")
    if not 0 <= share < 1:
        raise InvalidRange(
            f"min overlap {text}: must be >= 0 % and < 100 %; only a rig without baseline has it"
        )
    return share


def _pixels(text: str) -> float:
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+)\s*(MP|Mpx|px)\s*", text, re.IGNORECASE)
    if match is None:
        raise InvalidRange(f"max pixels {text or 'empty'}: must be a number with MP or px, as in 2MP")
    return float(match[1]) * (1 if match[2].lower() == "px" else 1e6)


def _cameras(resolution: str | None, sensor: str | None, lens: str | None, fov: str | None) -> list[Camera]:
    from rigsim.measure.sensor_presets import sensor_preset
    from rigsim.study.design import HFOVS_DEG, LENSES_MM, RESOLUTIONS
    from rigsim.theory.inverse import Camera

    if resolution is not None and sensor is not None:
        raise InvalidRange("--resolution and --sensor both given: a sensor has its own resolution, give one")
    unit, lenses = _lenses(lens)
    if sensor is not None and unit in ("", "mm"):
        return [
            Camera(chip.width, chip.height, mm * 1e3 / chip.pitch_um, f"{chip.name.upper()} with {mm:g} mm")
            for chip in (sensor_preset(name.strip()) for name in sensor.split(","))
            for mm in (lenses or LENSES_MM)
        ]
    if unit == "mm":
        raise InvalidRange(f"lens {lens}: mm need a --sensor with its pixel pitch; or give px or deg")
    if sensor is not None:
        chips = [sensor_preset(name.strip()) for name in sensor.split(",")]
        sizes = [((chip.width, chip.height), chip.name.upper()) for chip in chips]
    else:
        given = quantity.resolutions(resolution) if resolution is not None else RESOLUTIONS
        sizes = [(size, "") for size in given]
    if unit == "px":
        return [Camera(w, h, focal_px, name) for (w, h), name in sizes for focal_px in lenses]
    wanted = (quantity.value(fov, quantity.HFOV),) if fov is not None else ()
    angles = lenses or tuple(sorted({*HFOVS_DEG, *wanted}))
    return [
        Camera(w, h, w / 2 / math.tan(math.radians(deg) / 2), name)
        for (w, h), name in sizes
        for deg in angles
    ]


def _lenses(text: str | None) -> tuple[str, tuple[float, ...]]:
    """The unit of --lens, mm, px or deg, and its values in it; nothing when it is not given."""
    if text is None:
        return "", ()
    units = set(re.findall(r"[a-zA-Zµμ°]+", text))
    if not units:
        raise InvalidRig(f"lens {text or 'empty'}: mm, px or deg? Write the unit, as in 2.8,4,6,8mm")
    if units <= {"deg", "°"}:
        return "deg", quantity.values(text, quantity.HFOV)
    values, unit = quantity.focal_lengths(text)
    return unit, values
