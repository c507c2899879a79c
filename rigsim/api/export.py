"""`rigsim.export_rig` and `rigsim.export_dataset`: rigs and data sets as other programs read them."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.api.draw import rig_figure
from rigsim.api.kit.plain import takes
from rigsim.api.result import Result
from rigsim.api.rigs import RigLike, Several, read_rig, rig_for, told_of
from rigsim.rig import given
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.types import Figure, Table
    from rigsim.rig.sensor import Sensor


@dataclass(frozen=True, slots=True, eq=False)
class ExportedRig(Result):
    """A rig as another program's calibration files."""

    rig: StereoRig
    """The rig."""
    format: str
    """Whose files they are."""
    contents: Mapping[str, bytes]
    """The files by name."""
    command: str = ""
    """What the document names as the command."""
    remarks: tuple[Remark, ...] = ()
    """What the files were approximated by."""

    @property
    def table(self) -> Table:
        """One row a file: ``file`` and ``bytes``."""
        from rigsim.present.kit.types import table

        return table({"file": name, "bytes": len(content)} for name, content in self.contents.items())

    @property
    def verdict(self) -> tuple[str, ...]:
        """The files' names: nothing is concluded."""
        return tuple(self.contents)

    @property
    def headline(self) -> str:
        """What was made."""
        return f"{self.format}: {', '.join(self.contents)}"

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``rig``, from above."""
        return {"rig": lambda: rig_figure(self.rig)}

    def files(self) -> dict[str, bytes]:
        """The calibration files."""
        return dict(self.contents)

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The rig and its files; without `written` it names none."""
        from rigsim.interop.documents.base import Written
        from rigsim.interop.documents.export import export_rig_document

        return export_rig_document(
            self.command, self.format, self.rig, written or Written(folder="", files=[]), self.remarks
        )

    def print(self, folder: Path | None = None) -> None:
        """Print the files, and how they are read back."""
        from rigsim.present.kit.console import make_console

        said = f"{', '.join(self.contents)}"
        if folder is not None:
            said = f"{folder}: {said}; read it back with --rig {folder}"
        make_console().print(said, soft_wrap=True, markup=False, highlight=False)


def export_rig(rig: RigLike, format: str, *, approximate: bool = False, command: str = "") -> ExportedRig:
    """A rig as calibration files of another program; `ExportedRig.write` writes them.

    Args:
        rig: A preset's name, a calibration's path or text, or a rig.
        format: opencv, ros, kalibr, middlebury, colmap, mjcf, nerfstudio or mrcal.
        approximate: Whether a lens that the format lacks is fitted by the nearest one that it has; a remark
            tells by how many px it is off.
        command: What the document names as the command that made it.

    Raises:
        InvalidRange: There is no such format, or no such rig.
        InvalidRig: The format cannot hold the rig; the message names those that can.

    Example:
        >>> import rigsim
        >>> found = rigsim.export_rig("oak-d", "kalibr")
        >>> found.verdict
        ('camchain.yaml',)
        >>> rigsim.read_rig(found.files()["camchain.yaml"].decode()).baseline_m
        0.075
    """
    from rigsim.interop.formats.registry import approximate_files, rig_files

    one = read_rig(rig)
    if approximate:
        files, remarks = approximate_files(one, format)
        return ExportedRig(one, format, files, command, remarks)
    return ExportedRig(one, format, rig_files(one, format), command)


@dataclass(frozen=True, slots=True)
class DatasetOptions:
    """The arguments of `export_dataset`, which says what they mean."""

    rig: RigLike | None
    format: str
    frames: int
    folder: str | os.PathLike[str]
    _: KW_ONLY
    force: bool = False
    scene: str | os.PathLike[str] = "boards"
    mount: str | None = None
    move_mm: float | None = None
    turn_deg: float = 3.0
    sensor: str | Sensor | None = None
    blur_px: float | None = None
    image_noise_grey: Several = ()
    full_well_e: float | None = None
    read_noise_e: float | None = None
    seed: int = 0
    renderer: str = "auto"
    command: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ExportedDataset(Result):
    """A data set of rendered stereo pairs with their truth, on disk."""

    rig: StereoRig
    """The rig of all frames."""
    format: str
    """Whose layout it has."""
    scene: str
    """What was rendered."""
    folder: Path
    """Where it is."""
    names: tuple[str, ...]
    """The files there, with their folders."""
    views: Mapping[str, Any]
    """How many frames, and how they were taken: the document's own keys."""
    command: str = ""
    """What the document names as the command."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about the scene or the rig's place in it."""

    @property
    def table(self) -> Table:
        """One row a frame: its number, and the left camera's place in the scene, mm."""
        from rigsim.present.kit.types import table
        from rigsim.rig.pose import Pose

        rows: list[dict[str, object]] = []
        for frame in json.loads((self.folder / "manifest.json").read_text(encoding="utf-8"))["frames"]:
            pose = frame["left_from_world"]
            x, y, z = Pose(pose["R"], pose["t_m"]).inverse.t * 1e3
            rows.append({"frame": frame["frame"], "x_mm": float(x), "y_mm": float(y), "z_mm": float(z)})
        return table(rows)

    @property
    def verdict(self) -> int:
        """How many stereo pairs there are: nothing is concluded."""
        return int(self.views["frames"])

    @property
    def headline(self) -> str:
        """What was made."""
        pairs = "1 stereo pair" if self.verdict == 1 else f"{self.verdict} stereo pairs"
        return f"{pairs} of {self.scene} for {self.format}"

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``rig``, from above."""
        return {"rig": lambda: rig_figure(self.rig)}

    def files(self) -> dict[str, bytes]:
        """Every file, by its name with its folders: all of it in memory."""
        return {name: (self.folder / name).read_bytes() for name in self.names}

    def write(self, folder: str | os.PathLike[str], force: bool = False) -> Written:
        """Copy the data set; as `Result.write`."""
        from rigsim.interop.documents.base import Written
        from rigsim.interop.files.folder import folder_in_progress

        path = given.path(folder, "output folder")
        with folder_in_progress(path, force) as new:
            for name in self.names:
                (new / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(self.folder / name, new / name)
        return Written(folder=str(path), files=list(self.names))

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The data set in short."""
        from rigsim.interop.documents.base import Written
        from rigsim.interop.documents.export import export_dataset_document

        where = written or Written(folder=str(self.folder), files=list(self.names))
        remarks = [asdict(remark) for remark in self.remarks]
        said = {**self.views, "remarks": remarks}
        return export_dataset_document(self.command, self.format, self.rig, said, where)

    def print(self, folder: Path | None = None) -> None:
        """Print what was made, and how its rig is read."""
        from rigsim.present.kit.console import make_console

        said = f"{self.folder}: {self.headline}; the rig: --rig {self.folder}"
        make_console().print(said, soft_wrap=True, markup=False, highlight=False)


@takes(DatasetOptions)
def export_dataset(options: DatasetOptions) -> ExportedDataset:
    """Render stereo pairs from varied viewpoints, with true depth or disparity, masks and calibration.

    Each frame is written as it comes; the folder appears when the last one is done.

    Args:
        rig: A preset's name, a calibration's path or text, or a rig; None for the one that the scene is made
            for.
        format: middlebury, kitti, opencv or colmap.
        frames: How many stereo pairs.
        folder: Where to.
        force: Replace files that are there.
        scene: A bundled scene's name, or the path of an MJCF file.
        mount: Where the rig sits: ``body:NAME``, ``site:NAME`` or ``camera:NAME``.
        move_mm: Farthest move off the mount along each axis, mm; by default 5 % of the depth there.
        turn_deg: Farthest turn off the mount about each axis, deg.
        sensor: A sensor, or the name of one, as ``IMX477``; by default the rig file's.
        blur_px: Standard deviation of the lens's point spread, px.
        image_noise_grey: White noise of the pictures, grey levels of 255.
        full_well_e: Electrons that make full scale.
        read_noise_e: Read noise, electrons.
        seed: Seed of the viewpoints and the noise.
        renderer: auto, egl, osmesa or rays.
        command: What the files and the document name as the command that made them.

    Raises:
        InvalidRange: There is no such format, or a value is out of bounds.
        InvalidRig: The format cannot hold the rig.
        InvalidScene: Scene or mount cannot be used.
        OutputError: The folder cannot be written; nothing is left.

    Example:
        >>> import rigsim, tempfile
        >>> rig = rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(64, 48, 60.0), 0.06)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     found = rigsim.export_dataset(rig, "opencv", 2, folder, scene="bin", renderer="rays")
        ...     len(found.table), rigsim.read_rig(folder) == rig
        (2, True)
    """
    return _exported(options)


def _exported(options: DatasetOptions) -> ExportedDataset:
    from rigsim.api.kit.sensors import SensorOptions
    from rigsim.interop.files.dataset import check_format, nearest_m, write_dataset
    from rigsim.interop.files.folder import check_output
    from rigsim.sim.simulator import Simulator
    from rigsim.study.scene.frames import Views, render_frames
    from rigsim.study.scene.provenance import simulator_provenance

    scene, folder = str(given.path(options.scene, "scene")), given.path(options.folder, "output folder")
    rig, format, move_mm = rig_for(options.rig, scene), options.format, options.move_mm
    levels = given.reals(options.image_noise_grey, "image_noise_grey")
    optics = SensorOptions(options.sensor, options.blur_px, levels, options.full_well_e, options.read_noise_e)
    sensor = optics.one(told_of(options.rig).sensor)
    check_format(format, rig)
    check_output(folder, options.force)
    with Simulator(scene, options.mount, options.renderer) as simulator:
        simulator.place(rig)
        views = Views(
            count=options.frames,
            seed=options.seed,
            move_m=None if move_mm is None else move_mm / 1e3,
            turn_deg=options.turn_deg,
            nearest_m=nearest_m(format, rig),
        )
        made = render_frames(simulator, rig, views, sensor)
        asked = {"seed": options.seed, "move_mm": move_mm, "turn_deg": options.turn_deg}
        provenance = simulator_provenance(simulator)
        manifest = {**asked, "sensor": asdict(sensor), **provenance, "command": options.command}
        names = write_dataset(
            folder, format, rig, made, count=options.frames, manifest=manifest, force=options.force
        )
    said = {"frames": options.frames, **asked, "provenance": provenance}
    return ExportedDataset(rig, format, scene, folder, tuple(names), said, options.command, simulator.remarks)
