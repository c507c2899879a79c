"""The cameras that a design tries, and what is asked of them."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

import rigsim
from rigsim.api.kit.cameras import CameraOptions
from rigsim.cli.app import run
from rigsim.errors import InvalidRange
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.theory.inverse import Camera, Requirement, baseline_interval, relaxations
from tests.helpers.sampling import close


def only(options: CameraOptions) -> Camera:
    (camera,) = options.all(None)
    return camera


def test_a_pixel_pitch_turns_lenses_into_pixels() -> None:
    camera = only(CameraOptions([(1440, 1080)], lenses_mm=8, pixel_pitch_um=3.45))
    close(camera.focal_px, 8000 / 3.45)
    assert (camera.name, camera.pitch_um, camera.sensor) == ("8 mm lens", 3.45, "")
    # 1440 x 3.45 um are 4.968 mm
    close(only(CameraOptions([(1440, 1080)], lenses_mm=8, sensor_width_mm=4.968)).focal_px, 8000 / 3.45)


def test_a_sensor_may_be_cropped_binned_and_scaled() -> None:
    # imx477: 4056 x 3040 px of 1.55 um
    read = CameraOptions(sensors=("imx477",), lenses_mm=4)
    cropped = only(CameraOptions(sensors=("imx477",), lenses_mm=4, crop_px=(2000, 1000)))
    assert (cropped.width_px, cropped.height_px, cropped.merged) == (2000, 1000, 1)
    close(cropped.focal_px, only(read).focal_px)
    binned = only(CameraOptions(sensors=("imx477",), lenses_mm=4, binning=2))
    assert (binned.width_px, binned.height_px, binned.merged) == (2028, 1520, 2)
    close([binned.focal_px, binned.pitch_um], [only(read).focal_px / 2, 3.1])
    # 16:9 takes the whole width: 4056 / 1920 pixels as one
    scaled = only(CameraOptions([(1920, 1080)], ("imx477",), 4))
    close([scaled.merged, scaled.focal_px], [4056 / 1920, 4000 / 1.55 * 1920 / 4056])
    close(scaled.hfov_rad, only(read).hfov_rad)
    # and 1:1 the whole height
    close(only(CameraOptions([(1000, 1000)], ("imx477",), 4)).merged, 3.04)


def test_pixels_made_one_add_their_electrons() -> None:
    one = Sensor(full_well_e=8000, read_noise_e=3, dsnu_e=1, prnu_pct=0.6).merged(2)
    assert (one.full_well_e, one.read_noise_e, one.dsnu_e, one.prnu_pct) == (32000, 6, 2, 0.3)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (CameraOptions(sensors=("imx477",), crop_px=(5000, 100)), "imx477 has 4056x3040 px"),
        (CameraOptions([(5000, 100)], ("imx477",)), "has only 4056x3040 px"),
        (CameraOptions(sensors=("imx477",), binning=0), "must be a whole number from 1 to 16"),
        (CameraOptions(crop_px=(640, 480)), "name it by --sensor"),
        (CameraOptions(sensors=("imx477",), pixel_pitch_um=3.0), "each says how large a pixel is"),
        (CameraOptions(pixel_pitch_um=math.nan), "must be > 0"),
        (CameraOptions([(640, 480)], lenses_mm=4), "how large is a pixel"),
    ],
)
def test_what_no_camera_can_be(options: CameraOptions, words: str) -> None:
    with pytest.raises(InvalidRange, match=words):
        options.all(None)


CAMERA = Camera(1200, 900, 1000.0)


def test_heights_are_asked_of_the_camera_alone() -> None:
    # 900 px at 1000 px are 0.9 m at 1 m, and 2 atan(0.45) = 48.46 deg
    met, missed = (Requirement("cover_height", height, 2.0) for height in (1.79, 1.81))
    assert baseline_interval(CAMERA, [met], 0.25).is_feasible
    assert baseline_interval(CAMERA, [missed], 0.25).failed == (missed,)
    met, missed = (Requirement("vfov", math.radians(angle)) for angle in (48.4, 48.5))
    assert baseline_interval(CAMERA, [met], 0.25).is_feasible
    assert baseline_interval(CAMERA, [missed], 0.25).failed == (missed,)


def test_two_bodies_do_not_fit_closer() -> None:
    body, near = Requirement("min_baseline", 0.029), Requirement("max_disparity", 128.0, 0.2)
    interval = baseline_interval(CAMERA, [body, near], 0.25)
    # 128 px at 0.2 m: 25.6 mm
    close([interval.lower.baseline_m, interval.upper.baseline_m], [0.029, 0.0256])
    assert not interval.is_feasible
    # less noise would not help
    assert all(found.requirement is not None for found in relaxations([CAMERA], [body, near], 0.25))


def test_the_words_of_a_camera_and_what_it_covers(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = "--range 0.8:1.2m --depth-error 4mm@1.2m --pixel-pitch 3.45um --lens 6mm --resolution 1440x1080"
    more = "--cover 0.6x0.5m@1.2m --vfov 30deg --disparity-noise 0.3 --no-proof --json"
    more += " --body-width 29mm --min-baseline 20mm"  # the greater of the two holds
    assert run(["design", *words.split(), *more.split()]) == 0
    document = json.loads(capsys.readouterr().out)
    close(document["noise_px"], 0.3 / math.sqrt(2))
    close(document["recommended"]["focal_mm"], 6)
    asked = {item["requirement"]: (item["required"], item["verdict"]) for item in document["requirements"]}
    assert asked["cover"] == (600, "met")
    assert asked["cover_height"] == (500, "met")
    assert asked["min_baseline"] == (29, "met")
    close(asked["vfov"][0], 30)


def test_noise_is_said_once() -> None:
    with pytest.raises(InvalidRange, match=r"sqrt\(2\) times a coordinate's, give one"):
        rigsim.design((1, 3), depth_error_mm=20, noise_px=0.25, disparity_noise_px=0.35, proof=False)


def test_what_a_placed_rig_shows_of_heights() -> None:
    import numpy as np

    from rigsim.rig.noise import PixelNoise
    from rigsim.study.design.checks import RigInScene, check

    rig = StereoRig.rectified(rigsim.Intrinsics.from_focal(1200, 900, 1000.0), 0.1)
    none = np.empty((0, 3))
    sight = RigInScene(rig, 0.1, (1200, 900), none, none[:, 0], PixelNoise(0.25), 1, None)
    held = check(Requirement("cover_height", 1.0, 2.0), sight, np.random.default_rng(0))
    close(held.simulated, 1.8, rtol=1e-4)
    held = check(Requirement("vfov", 0.5), sight, np.random.default_rng(0))
    close(held.simulated, 2 * math.atan(0.45), rtol=1e-9)


def test_a_view_that_nobody_asked_for_is_remarked_on() -> None:
    asked = {"range_m": (5, 20), "depth_error_pct": 5, "pixel_pitch_um": 3, "resolutions_px": (1280, 800)}
    asked |= {"lenses_mm": (2.8, 25), "proof": False}
    # 1280 px x 3 um are 3.84 mm: 25 mm see 8.78 deg of them, 2.8 mm 68.9 deg
    (told,) = rigsim.design(**asked, prefer="smallest").remarks
    assert told.text.startswith("the rig sees 8.78° across: no field of view was asked for")
    assert rigsim.design(**asked, fov_deg=60).remarks == ()
    assert rigsim.design(**{**asked, "lenses_mm": 25}).remarks == ()


def test_what_is_covered_at_the_far_end_alone_is_remarked_on() -> None:
    asked = {"range_m": (1, 1.4), "depth_error_mm": 3, "pixel_pitch_um": 3.45, "lenses_mm": 4, "proof": False}
    asked |= {"resolutions_px": (1440, 1080)}
    found = rigsim.design(**asked, cover_mm=(1000, 600))
    (told,) = found.remarks
    # by hand: Z W pitch / f - B at 1 m
    near_mm = 1000 * 1440 * 0.00345 / 4 - 1e3 * found.rig.baseline_m
    assert near_mm < 1000
    assert f"at 1 m both cameras see {near_mm:.3g} mm: --cover WxH@1m asks for it there" in told.text
    for at_m in (1, 1.4):  # said in so many words
        assert rigsim.design(**asked, cover_mm=(1000, 600), cover_at_m=at_m).remarks == ()
