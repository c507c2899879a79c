"""`rigsim.design`: from requirements to a rig, proved in a scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from rigsim.api.kit.cameras import cameras_tried
from rigsim.api.kit.cover import cover
from rigsim.api.kit.golden import print_comparison
from rigsim.api.kit.plain import takes
from rigsim.api.kit.requirements import DesignOptions, specified
from rigsim.api.kit.sensors import SensorOptions
from rigsim.api.kit.trial import Place, fittings, has_own_noise, try_out
from rigsim.api.result import Result
from rigsim.rig import given
from rigsim.rig.remark import Remark
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.counted import calibration_remarks
from rigsim.study.design.proof import Proof, recommended
from rigsim.study.design.solve import Candidate, Design, solve
from rigsim.study.design.tolerance import DesignTolerance, design_tolerance
from rigsim.study.design.view import view_remarks

if TYPE_CHECKING:
    from rigsim.interop.documents.base import Written
    from rigsim.present.kit.page import Cover
    from rigsim.present.kit.types import Figure, Table
    from rigsim.study.design.least import LeastSize
    from rigsim.study.golden.compare import GoldenReport


@dataclass(frozen=True, slots=True, eq=False)
class Designed(Result):
    """The rig to take, what else would do, and whether it was proved."""

    found: Design
    """Everything the formulas say."""
    proofs: tuple[Proof, ...]
    """What became of the rigs that were tried; empty when no proof was asked for."""
    tolerance: DesignTolerance | None
    """What the build must hold; None where no built rig can be judged."""
    sensor: Sensor | None
    """What rig.toml says of the sensor; None for nothing."""
    command: str = ""
    """What the page names as the command that made it."""
    remarks: tuple[Remark, ...] = ()
    """What is odd about the scene or the rigs' place in it."""
    cover: Cover | None = None
    """Title, note and logo of one's own report; None for none."""
    golden: GoldenReport | None = None
    """How the numbers compare with golden results; None when it was not asked."""

    @property
    def rig(self) -> StereoRig:
        """The rig to take."""
        return recommended(self.found, self.proofs).rig

    @property
    def table(self) -> Table:
        """One row a rig that no other beats in all of error, baseline, field of view and pixels."""
        from rigsim.present.kit.types import table

        return table(self.document()["pareto"])

    @property
    def verdict(self) -> Literal["verified", "not verified", "not tried"]:
        """Whether simulation and pixels keep what the formulas promised of the rig to take."""
        if not self.proofs:
            return "not tried"
        return "verified" if self.proofs[-1].verified else "not verified"

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        from rigsim.present.design.console import headline

        return headline(self.found, self.proofs)

    @property
    def smallest_resolution(self) -> Candidate | None:
        """Of the sizes tried, the candidate with the fewest pixels that would do; None for none, or where one
        size was tried."""
        from rigsim.study.design.buildable import smallest_resolution

        return smallest_resolution(self.found)

    @property
    def least_size(self) -> LeastSize | None:
        """The image that would just do without build errors, in the field of view and shape of the rig to
        take, tried or not; None where nothing limits the baseline."""
        from rigsim.study.design.least import least_size

        return least_size(recommended(self.found, self.proofs), self.found.specification)

    @property
    def figures(self) -> Mapping[str, Callable[[], Figure]]:
        """``region``: what is feasible; ``pareto``: the choice; ``plan``: the rig from above."""
        from rigsim.present.design import figures

        pick = recommended(self.found, self.proofs)
        return {
            "region": lambda: figures.region_figure(self.found, pick),
            "pareto": lambda: figures.pareto_figure(self.found, pick),
            "plan": lambda: figures.plan_figure(self.found, pick, self.proofs),
        }

    def files(self) -> dict[str, bytes]:
        """rig.toml, design.json and design.html."""
        from rigsim.interop.documents.text import json_text
        from rigsim.interop.formats.rig_toml import write_rig
        from rigsim.present.design.page import design_html

        document = self.document()
        comment = f"rigsim design: {document['recommended']['reason']}"
        page = design_html(self.found, self.proofs, self.tolerance, self.command, self.cover)
        return {
            "rig.toml": write_rig(self.rig, comment, self.sensor).encode(),
            "design.json": (json_text(document) + "\n").encode(),
            "design.html": page.encode(),
        }

    def document(self, written: Written | None = None) -> Mapping[str, Any]:
        """The whole answer; docs/reference/design.md says what the keys mean."""
        from rigsim.interop.documents.design.document import design_document
        from rigsim.present.design import words

        return design_document(self.found, self.proofs, self.tolerance, words, self.golden)

    def print(self, folder: Path | None = None) -> None:
        """Print the rig to take, what binds it, and what became of the proof."""
        from rigsim.present.design.console import print_design

        print_design(self.found, self.proofs, self.tolerance, folder)
        print_comparison(self.golden)


@takes(DesignOptions)
def design(options: DesignOptions) -> Designed:
    """Find the rigs that meet requirements, recommend one, and verify it by simulation.

    Args:
        range_m: Working range, (near, far), m.
        depth_error_mm: Depth errors allowed, mm, root mean square of one rig with its noise.
        depth_error_pct: The same in percent of the distance, instead.
        at_m: Their distances, m; the far end by default.
        p95: Whether 95 of 100 errors are to stay under them instead.
        errors: More of them, each a `DepthError`.
        fov_deg: Horizontal field of view, at least, deg.
        vfov_deg: Vertical field of view, at least, deg.
        cover_mm: Width that both cameras see, at least, mm; or (width, height).
        cover_at_m: Where, m; the far end by default.
        max_baseline_mm: Longest baseline, mm.
        min_baseline_mm: Shortest baseline, mm.
        body_width_mm: Width of a camera's body, mm: two do not fit closer. Without it and
            `min_baseline_mm`, that of a usual camera with the sensor, where one is known; 0 for none.
        max_disparity_px: Disparities that the matcher searches, px.
        max_pixels: Most pixels of one image.
        min_overlap: Least shares of the left image seen by the right, 0 to 1; by default 0.5 at the near end.
        min_overlap_at_m: Their distances, m; the near end by default.
        nearest_focus_m: Nearest distance at which the lenses draw sharply, m.
        calibration: Path of a covariance.json, plan.json or calibration.json of `rigsim calibrate`: what it
            leaves of a disparity counts in every depth error, noise and calibration adding as squares.
        noise_px: Standard deviation of the noise of one pixel coordinate, px; by default 0.25, or with
            `sensors` what is measured in pictures taken with them.
        disparity_noise_px: Standard deviation of a disparity, px, instead: sqrt(2) times as much.
        build_share: Share of that error's variance that noise leaves for errors of mounting and calibration.
        max_row_error_px: Largest row misalignment of a built rig's rectified pair, root mean square over the
            image, at every distance of the range, px: counted in the yields; any by default.
        resolutions_px: Image sizes to try, (width, height), px; `sensors` are scaled down to them. With
            `pixel_pitch_um` a smaller one is a crop, which sees less behind the same lens; with
            `sensor_width_mm` it has larger pixels, and sees the same.
        sensors: Names of sensors to try.
        pixel_pitch_um: Pixel pitch of cameras without a sensor's name, micrometres.
        sensor_width_mm: Width of their pixels together, mm, instead.
        crop_px: Part of the sensors that is read, (width, height), px.
        binning: Pixels across, and down, that the sensors read as one.
        lenses_mm: Focal lengths to try, mm; they need `sensors`, a pixel pitch or a sensor's width.
        lenses_px: Focal lengths to try, px, instead.
        lenses_deg: Horizontal fields of view to try, deg, instead.
        prefer: buildable (the cheapest of which 95 of 100 built rigs are good), smallest (baseline), cheapest
            (fewest pixels, then baseline) or most-accurate.
        scene: Where the pick is proved: auto makes a scene for the range, with something to see at every
            distance asked for; else a bundled scene's name, or the path of an MJCF file.
        proof: Whether anything is rendered and simulated; else it is formulas only.
        measure: What is measured in the pictures: auto, corners, patches, dense or none.
        blur_px: Standard deviation of the lens's point spread, px.
        image_noise_grey: White noise of the pictures, grey levels of 255.
        full_well_e: Electrons that make full scale.
        read_noise_e: Read noise, electrons.
        tolerance_class: Who builds it: printed, machined or calibrated.
        tolerances: Tolerances in place of the class's, by name as in `tolerance`.
        bounds: Names of those that are bounds.
        seed: Seed of every random number.
        renderer: auto, egl, osmesa or rays.
        command: What the page names as the command that made it.
        title: Title of the report, in place of its own.
        note: A paragraph of the report.
        logo: Path of a picture at its head, PNG or SVG.
        ready: Is called once all that can be refused without drawing has been checked.

    Raises:
        InvalidRange: A value is out of bounds, or two say the same thing.
        InvalidRig: No rig meets the requirements; the message says which one to relax, and by how much.
        InvalidScene: The scene cannot be used.
        RenderUnavailable: The renderer asked for does not work here.

    Example:
        >>> import rigsim
        >>> found = rigsim.design(
        ...     range_m=(1, 3), depth_error_mm=20, resolutions_px=(1280, 960), lenses_deg=60, proof=False
        ... )
        >>> found.verdict
        'not tried'
        >>> rig = found.rig
        >>> error_m = 3**2 / (rig.left.fx * rig.baseline_m) * 2**0.5 * 0.25  # Z^2 / (f B) of disparity
        >>> error_m < 0.020
        True
    """
    return _designed(options)


def _designed(options: DesignOptions) -> Designed:
    head = cover(options.title, options.note, options.logo)
    specification, cameras = specified(options), cameras_tried(options)
    levels = given.reals(options.image_noise_grey, "image_noise_grey")
    optics = SensorOptions(None, options.blur_px, levels, options.full_well_e, options.read_noise_e)
    fits = fittings(cameras, optics)
    measures_noise = bool(
        options.sensors
        and options.noise_px is None
        and options.disparity_noise_px is None
        and options.proof
        and options.measure != "none"
    )
    proofs: tuple[Proof, ...] = ()
    remarks: tuple[Remark, ...] = ()
    if not measures_noise:  # what cannot be is said before anything is drawn
        found = solve(specification, cameras, options.prefer)
    if options.ready is not None:
        options.ready()
    if options.proof:
        scene = str(given.path(options.scene, "scene"))
        place = Place(scene, options.seed, options.renderer, options.measure)
        found, proofs, remarks = try_out(specification, cameras, options.prefer, place, fits, measures_noise)
    pick = recommended(found, proofs)
    remarks = (*remarks, *view_remarks(found, pick, options.cover_at_m is None))
    counted = calibration_remarks(found.specification.calibration, pick.camera, pick.baseline_m)
    remarks = (*remarks, *counted)
    held = design_tolerance(found.specification, pick, options.seed, found.candidates)
    told = has_own_noise(pick.camera.sensor, optics) or options.blur_px is not None
    sensor = fits[pick.camera.sensor, pick.camera.merged].sensor if told else None
    return Designed(found, proofs, held, sensor, options.command, remarks, head)
