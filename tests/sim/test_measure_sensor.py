"""Sensor: noise against the photon transfer curve, distortion against projected corners."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.subjects.checker_images import board_corners, board_homography, board_image
from benchmarks.subjects.corners import refine_corners
from rigsim.errors import InvalidImage, InvalidRig
from rigsim.rig.catalogue.sensors import SENSORS, SensorPreset, sensor_preset
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.sensor import Sensor
from rigsim.sim.exposure import average_pixels, digitise, expose, optics
from rigsim.sim.lens import distort_image, rectify_image, wider_intrinsics

RAMP = np.linspace(0.0, 1.0, 256).reshape(16, 16)


class TestIdeal:
    def test_the_default_sensor_only_rounds(self) -> None:
        grey = expose(RAMP, Sensor(), np.random.default_rng(0))
        assert grey.dtype == np.uint8
        np.testing.assert_array_equal(grey.ravel(), np.arange(256))

    def test_without_a_converter_nothing_changes(self) -> None:
        image = np.random.default_rng(1).uniform(-0.5, 1.5, (7, 9, 3))
        np.testing.assert_array_equal(expose(image, Sensor(bits=0), np.random.default_rng(0)), image)

    @pytest.mark.parametrize(
        ("bits", "top", "kind"), [(8, 255, np.uint8), (10, 1023, np.uint16), (12, 4095, np.uint16)]
    )
    def test_bits_set_full_scale_and_clip(self, bits: int, top: int, kind: type) -> None:
        grey = expose(np.array([[-0.2, 0.0, 0.5, 1.0, 1.7]]), Sensor(bits=bits), np.random.default_rng(0))
        assert grey.dtype == kind
        assert grey.ravel().tolist() == [0, 0, round(top / 2), top, top]


class TestOptics:
    def test_blur_spreads_a_point_by_its_std_and_keeps_its_light(self) -> None:
        point = np.zeros((41, 41))
        point[20, 20] = 1.0
        seen = optics(point, Sensor(blur_px=1.3))
        u = np.arange(41) - 20
        assert seen.sum() == pytest.approx(1.0, abs=1e-6)
        assert (seen.sum(axis=0) * u).sum() == pytest.approx(0.0, abs=1e-9)
        assert math.sqrt((seen.sum(axis=0) * u**2).sum()) == pytest.approx(1.3, rel=2e-3)
        assert math.sqrt((seen.sum(axis=1) * u**2).sum()) == pytest.approx(1.3, rel=2e-3)

    def test_the_lens_blurs_before_the_pixels_sample(self) -> None:
        # a step at 10.3: blurred by 0.5 px and averaged over pixels its variance is 0.25 + 1/12
        k = 10
        fine = np.broadcast_to(((np.arange(20 * k) + 0.5) / k - 0.5 > 10.3).astype(float), (20 * k, 20 * k))
        seen = optics(fine, Sensor(blur_px=0.5), supersample=k)
        assert seen.shape == (20, 20)
        spread = np.diff(seen[5])
        at = np.arange(19) + 0.5
        assert (spread * at).sum() == pytest.approx(10.3, abs=1e-6)
        assert (spread * (at - 10.3) ** 2).sum() == pytest.approx(0.25 + 1 / 12 + 1 / 12, abs=0.005)

    def test_fine_pixels_are_averaged(self) -> None:
        image = np.arange(24.0).reshape(4, 6)
        assert average_pixels(image, 2).tolist() == [[3.5, 5.5, 7.5], [15.5, 17.5, 19.5]]
        assert average_pixels(np.dstack([image, 2 * image]), 2)[1, 2].tolist() == [19.5, 39.0]
        with pytest.raises(InvalidImage, match="6 x 4 px: no whole multiple of the supersampling 4"):
            average_pixels(image, 4)

    def test_colours_do_not_mix(self) -> None:
        image = np.zeros((9, 9, 3))
        image[4, 4, 1] = 1.0
        seen = optics(image, Sensor(blur_px=1.0))
        assert seen[..., [0, 2]].max() == 0.0
        np.testing.assert_allclose(seen[..., 1], optics(image[..., 1], Sensor(blur_px=1.0)))

    def test_vignetting_is_what_the_corners_lose(self) -> None:
        seen = optics(np.ones((31, 41)), Sensor(vignetting=0.3))
        assert seen[15, 20] == 1.0
        assert seen[[0, 0, -1, -1], [0, -1, 0, -1]] == pytest.approx([0.7] * 4)
        # half way out along the diagonal: a quarter of the loss
        assert optics(np.ones((5, 5)), Sensor(vignetting=0.4))[1, 1] == pytest.approx(0.9)

    def test_only_the_right_picture_is_mismatched(self) -> None:
        sensor = Sensor(right_gain=1.1, right_offset=0.02)
        np.testing.assert_array_equal(optics(RAMP, sensor, "left"), RAMP)
        np.testing.assert_allclose(optics(RAMP, sensor, "right"), 1.1 * RAMP + 0.02)

    def test_grey_levels_are_refused_for_light(self) -> None:
        for image in (np.zeros((3, 3), np.uint8), np.zeros(3), np.zeros((2, 2, 2, 2))):
            with pytest.raises(InvalidImage, match="linear image of shape"):
                optics(image, Sensor())


class TestNoise:
    def test_photon_transfer_by_hand(self) -> None:
        # 10000 e- in 255 levels: k = 0.0255 levels an electron. At level 102, 4000 e-: shot 63.25 e-, read
        # 20 e-, so 66.33 e- = 1.6915 levels; with rounding sqrt(1.6915^2 + 1/12) = 1.7160
        sensor = Sensor(full_well_e=10000, read_noise_e=20)
        assert float(sensor.noise_std(102)) == pytest.approx(1.7160, abs=2e-4)
        light = np.full((300, 300), 102 / 255)
        grey = digitise(light, sensor, np.random.default_rng(2)).astype(float)
        assert grey.std() == pytest.approx(1.7160, rel=0.01)
        assert grey.mean() == pytest.approx(102, abs=0.03)

    @settings(max_examples=25, deadline=None)
    @given(
        level=st.floats(0.2, 0.8),
        well=st.floats(2000, 40000),
        read=st.floats(0, 30),
        gain=st.floats(1, 4),
        white=st.floats(0, 3),
        bits=st.sampled_from([8, 10, 12]),
    )
    def test_the_variance_is_the_one_announced(
        self, level: float, well: float, read: float, gain: float, white: float, bits: int
    ) -> None:
        sensor = Sensor(full_well_e=well, read_noise_e=read, gain=gain, grey_noise=white, bits=bits)
        grey = digitise(np.full((100, 100), level), sensor, np.random.default_rng(3)).astype(float)
        announced = float(sensor.noise_std(level * sensor.full_scale))
        # below a level of noise, rounding is no longer 1/12 of white noise
        if announced > 0.7:
            assert grey.std() == pytest.approx(announced, rel=0.05)

    def test_gain_trades_electrons_for_noise(self) -> None:
        one, four = Sensor(full_well_e=8000, bits=0), Sensor(full_well_e=8000, gain=4, bits=0)
        assert float(four.noise_std(0.5) / one.noise_std(0.5)) == pytest.approx(2.0)

    def test_grey_noise_is_in_levels_of_eight_bits(self) -> None:
        light = np.full((200, 200), 0.5)
        assert digitise(light, Sensor(grey_noise=2), np.random.default_rng(1)).std() == pytest.approx(
            2.02, rel=0.02
        )
        assert digitise(
            light, Sensor(grey_noise=2, bits=12), np.random.default_rng(1)
        ).std() == pytest.approx(2 * 4095 / 255, rel=0.02)

    def test_many_frames_of_one_picture(self) -> None:
        sensor = Sensor(full_well_e=5000, read_noise_e=5)
        light = optics(RAMP, sensor)
        frames = digitise(light, sensor, np.random.default_rng(4), frames=200)
        assert frames.shape == (200, 16, 16)
        again = digitise(light, sensor, np.random.default_rng(4), frames=200)
        np.testing.assert_array_equal(frames, again)
        flat = frames.reshape(200, -1)[:, 40:200].astype(float)
        np.testing.assert_allclose(
            flat.std(axis=0).mean(), sensor.noise_std(np.arange(40, 200)).mean(), rtol=0.02
        )
        correlation = np.corrcoef(flat[:, 0], flat[:, 1])[0, 1]
        assert abs(correlation) < 0.25
        assert digitise(np.zeros((4, 5, 3)), sensor, np.random.default_rng(0), frames=2).shape == (2, 4, 5, 3)


def dark_and_grey(sensor: Sensor, light: float, n: int = 200) -> np.ndarray:
    """Grey levels (n, 100, 100) of frames of even light."""
    return digitise(np.full((100, 100), light), sensor, np.random.default_rng(7), frames=n).astype(float)


class TestEmva:
    """EMVA 1288: what photon transfer reads out of frames is what went into them."""

    SENSOR = Sensor(full_well_e=8000, read_noise_e=6, gain=16, bits=8, black_level=32)

    def test_the_dark_is_the_black_level_with_all_of_the_read_noise(self) -> None:
        # 255 levels x 16 / 8000 e- = 0.51 an electron: 6 e- are 3.06 levels, with rounding
        # sqrt(3.06^2 + 1/12) = 3.0736; cut off at 0 it would be 0.58 of that, with a mean of 0.4 x 3.06
        dark = dark_and_grey(self.SENSOR, 0.0)
        assert dark.mean() == pytest.approx(32.0, abs=0.02)
        assert dark.std() == pytest.approx(3.0736, rel=0.01)
        cut = dark_and_grey(replace(self.SENSOR, black_level=0), 0.0, n=20)
        assert cut.mean() == pytest.approx(3.06 / math.sqrt(2 * math.pi), rel=0.02)

    @pytest.mark.parametrize("bits", [8, 12])
    def test_the_slope_of_variance_over_mean_is_the_levels_an_electron(self, bits: int) -> None:
        sensor = replace(self.SENSOR, bits=bits)
        k = (2**bits - 1) * 16 / 8000
        assert sensor.grey_per_electron == pytest.approx(k)
        pairs = [dark_and_grey(sensor, light) for light in (0.0, 0.2, 0.4, 0.6)]
        means = [frames.mean() for frames in pairs]
        variances = [frames.var(axis=0, ddof=1).mean() for frames in pairs]
        slope, dark_variance = np.polyfit(np.array(means) - means[0], variances, 1)
        assert slope == pytest.approx(k, rel=0.01)
        assert dark_variance == pytest.approx((6 * k) ** 2 + 1 / 12, rel=0.02)
        assert means[0] == pytest.approx(32 / 255 * (2**bits - 1), rel=0.01)
        assert float(sensor.noise_std(means[2])) ** 2 == pytest.approx(variances[2], rel=0.02)

    def test_few_photons_are_counted(self) -> None:
        # 3 e- on average: P(0) = exp(-3) = 0.0498, P(1) = 0.1494; a Gaussian would make half electrons
        sensor = Sensor(full_well_e=300, gain=100, bits=0)
        electrons = dark_and_grey(sensor, 1.0) * 3
        np.testing.assert_allclose(electrons, np.rint(electrons), atol=1e-9)
        assert (electrons < 0.5).mean() == pytest.approx(math.exp(-3), rel=0.02)
        assert (np.abs(electrons - 1) < 0.5).mean() == pytest.approx(3 * math.exp(-3), rel=0.02)
        # skewness of Poisson: 1 / sqrt(3)
        assert ((electrons - 3) ** 3).mean() / 3**1.5 == pytest.approx(1 / math.sqrt(3), rel=0.03)

    def test_prnu_and_dsnu_are_read_as_the_standard_reads_them(self) -> None:
        sensor = Sensor(full_well_e=10000, read_noise_e=4, bits=12, black_level=20, prnu_pct=1.5, dsnu_e=8)
        k = 0.4095
        dark, half = (dark_and_grey(sensor, light).mean(axis=0) for light in (0.0, 0.5))
        assert dark.std() / k == pytest.approx(8, rel=0.02)
        prnu = math.sqrt(half.var() - dark.var()) / (half.mean() - dark.mean())
        assert 100 * prnu == pytest.approx(1.5, rel=0.03)

    def test_the_pattern_is_a_cameras_own(self) -> None:
        sensor = Sensor(bits=0, prnu_pct=2)
        light = np.full((40, 50), 0.5)
        first, again, right = (
            digitise(light, sensor, np.random.default_rng(seed), side)
            for seed, side in ((1, "left"), (2, "left"), (1, "right"))
        )
        np.testing.assert_array_equal(first, again)
        assert abs(np.corrcoef(first.ravel(), right.ravel())[0, 1]) < 0.1


class TestBadSensors:
    @pytest.mark.parametrize(
        ("numbers", "message"),
        [
            ({"blur_px": -0.1}, "lens blur -0.1 px: must be >= 0"),
            ({"blur_px": math.nan}, "lens blur nan px"),
            ({"full_well_e": -1}, "full well -1 e-"),
            ({"read_noise_e": 2.0}, "read noise 2 e- without a full well: give full_well_e"),
            ({"read_noise_e": math.inf, "full_well_e": 1}, "read noise inf e-"),
            ({"dsnu_e": 2.0}, "DSNU 2 e- without a full well: give full_well_e"),
            ({"prnu_pct": -1}, "PRNU -1 %: must be >= 0"),
            ({"black_level": 255}, "black level 255: must be >= 0 and < 255"),
            ({"full_well_e": 1e15, "gain": 1e-9}, "at most 1e\\+15 electrons"),
            ({"grey_noise": -2}, "grey noise -2: must be >= 0"),
            ({"gain": 0}, "gain 0: must be > 0"),
            ({"right_gain": -1}, "right gain -1: must be > 0"),
            ({"right_offset": 1.5}, "right offset 1.5: must be between -1 and 1"),
            ({"vignetting": 1.0}, "vignetting 1: must be >= 0 and < 1"),
            ({"bits": 9}, "9 bits: must be one of 0, 8, 10, 12"),
        ],
    )
    def test_one_line_with_value_and_bound(self, numbers: dict[str, float], message: str) -> None:
        with pytest.raises(InvalidRig, match=message) as caught:
            Sensor(**numbers)
        assert "\n" not in str(caught.value)


class TestPresets:
    def test_every_number_has_its_source(self) -> None:
        for name, preset in SENSORS.items():
            assert preset.name == name == name.lower()
            assert preset.geometry_source
            assert bool(preset.noise_source) == (
                preset.full_well_e is not None or preset.read_noise_e is not None
            )
            assert preset.shutter in ("global", "rolling", None)
            assert preset.shutter_source.startswith("none found: ") == (preset.shutter is None)
            assert 1 <= preset.pitch_um <= 7
            assert 640 <= preset.width <= 6000
            assert 0.5 < preset.height / preset.width <= 1

    def test_those_of_industry_are_there(self) -> None:
        known = [preset for preset in SENSORS.values() if preset.shutter is not None]
        assert len(known) >= 15
        asked = "imx264 imx265 imx273 imx287 imx290 imx304 imx392 imx540 imx541 imx542 ar0144 ar0234 ov9281"
        assert set(asked.split()) <= set(SENSORS)
        rolling = {preset.name for preset in known if preset.shutter == "rolling"}
        assert {"imx219", "imx477", "imx178", "imx226", "imx462", "mt9m034"} <= rolling
        assert not rolling & {"imx264", "imx265", "imx273", "imx287", "imx304", "imx541", "ar0144", "ov9281"}

    @pytest.mark.parametrize("preset", SENSORS.values(), ids=lambda preset: preset.name)
    def test_electrons_follow_from_what_the_source_says(self, preset: SensorPreset) -> None:
        """The source's own words: dB by EMVA 1288, or electrons."""
        decibels = re.search(r"SNR(?:_max)? ([\d.]+) dB, DR ([\d.]+) dB", preset.noise_source)
        if decibels:
            snr_db, dr_db = map(float, decibels.groups())
            full_well_e = 10 ** (snr_db / 10)
            least_e = full_well_e / 10 ** (dr_db / 20)
            assert preset.full_well_e == pytest.approx(full_well_e, abs=0.5)
            # one electron of quantisation, 1/2 of signal that still counts: read noise is what is left
            assert preset.read_noise_e == pytest.approx(math.sqrt((least_e - 0.5) ** 2 - 0.25), abs=0.006)
        for quoted, kept in (("saturation", preset.full_well_e), ("dark noise", preset.read_noise_e)):
            electrons = re.search(rf"{quoted} ([\d.]+) e-", preset.noise_source)
            if electrons:
                assert kept == float(electrons[1])

    def test_most_electrons_are_checked_against_their_source(self) -> None:
        measured = [preset for preset in SENSORS.values() if preset.noise_source]
        quoting = [p for p in measured if re.search(r"DR [\d.]+ dB|dark noise", p.noise_source)]
        assert len(quoting) >= 15
        # a photon transfer curve, a conversion gain, and a data sheet in ke-
        assert {p.name for p in measured} - {p.name for p in quoting} == {"imx477", "imx264", "ov5647"}

    @pytest.mark.parametrize(
        ("name", "width_mm", "height_mm"),
        [
            ("imx273", 4.97, 3.73),  # 1440 x 3.45 um
            ("imx304", 14.19, 10.38),
            ("imx287", 4.97, 3.73),  # pixels twice as wide, half as many
            ("imx265", 7.07, 5.30),
            ("imx541", 12.36, 12.36),
            ("imx174", 11.34, 7.13),
            ("ov9281", 3.84, 2.40),
            ("imx226", 7.44, 5.62),
        ],
    )
    def test_the_active_area_is_that_of_the_data_sheet(
        self, name: str, width_mm: float, height_mm: float
    ) -> None:
        preset = SENSORS[name]
        assert preset.sensor_width_mm == pytest.approx(width_mm, abs=0.006)
        assert preset.height * preset.pitch_um * 1e-3 == pytest.approx(height_mm, abs=0.006)

    @pytest.mark.parametrize(
        ("name", "diagonal_mm"),
        [
            *(("imx273", 6.3), ("imx265", 8.9), ("imx392", 7.9), ("imx267", 16.1), ("imx226", 9.33)),
            *(("imx304", 17.58), ("imx540", 19.3), ("imx541", 17.5), ("imx542", 16.8), ("imx174", 13.4)),
            *(("imx545", 14.0), ("imx546", 11.0), ("imx547", 8.8), ("imx264", 11.1), ("imx250", 11.1)),
        ],
    )
    def test_the_makers_of_cameras_state_the_same_diagonal(self, name: str, diagonal_mm: float) -> None:
        """Of all the effective pixels, of which a camera delivers 1.5 % less by default."""
        preset = SENSORS[name]
        found = math.hypot(preset.width, preset.height) * preset.pitch_um * 1e-3
        assert found == pytest.approx(diagonal_mm, rel=0.015)

    def test_a_published_sensor_is_ready_and_may_be_overruled(self) -> None:
        preset = sensor_preset("IMX477")
        assert preset.sensor() == Sensor(full_well_e=8180, read_noise_e=3, bits=12)
        assert preset.sensor(read_noise_e=5, gain=2, bits=8) == Sensor(
            full_well_e=8180, read_noise_e=5, gain=2, bits=8
        )
        assert preset.sensor_width_mm == pytest.approx(6.29, abs=0.01)

    def test_what_is_not_published_has_to_be_given(self) -> None:
        with pytest.raises(
            InvalidRig, match="sensor imx219: no published full_well_e and read_noise_e: give it"
        ):
            sensor_preset("imx219").sensor()
        with pytest.raises(InvalidRig, match="sensor ov5647: no published read_noise_e"):
            sensor_preset("ov5647").sensor()
        assert sensor_preset("ov5647").sensor(read_noise_e=4).full_well_e == 4300

    def test_an_unknown_sensor_lists_those_there_are(self) -> None:
        with pytest.raises(InvalidRig, match=r"unknown sensor 'kodak': choose one of imx219, imx296"):
            sensor_preset("kodak")


LENS = BrownConrady(-0.25, 0.08, 0.001, -0.0008)
CAMERA = Intrinsics(320, 240, 225.0, 226.0, 158.6, 121.3, LENS)
PINHOLE = replace(CAMERA, lens=None)
ROWS, COLS = 4, 5
PLACES = (((-0.42, -0.28), 0.06, 0.2), ((0.33, 0.25), 0.07, -0.4), ((0.4, -0.33), 0.05, 0.7))


def normalized_corners(place: tuple[float, float], square: float, roll: float) -> np.ndarray:
    return board_corners(board_homography(place, square, roll=roll, tilt=0.0), ROWS, COLS)


@lru_cache(maxsize=4)
def wide_picture(camera: Intrinsics, blur: float) -> np.ndarray:
    boards = [(camera.K @ board_homography(*args[:2], roll=args[2], tilt=0.0), ROWS, COLS) for args in PLACES]
    return board_image(boards, (camera.height, camera.width), blur=blur, supersample=2 if blur >= 1 else 4)


def rms_at(image: np.ndarray, camera: Intrinsics) -> float:
    errors = []
    for args in PLACES:
        exact = camera.denormalize(normalized_corners(*args))
        grid = exact.reshape(ROWS, COLS, 2)
        steps = np.stack([np.gradient(grid, axis=1), np.gradient(grid, axis=0)], axis=-2).reshape(-1, 2, 2)
        found = refine_corners(image, exact, steps=steps)
        assert found.valid.all()
        errors.append(found.uv - exact)
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


class TestDistortion:
    @pytest.mark.parametrize("supersample", [2, 3])
    def test_rendered_distorted_and_rectified_corners_are_where_they_belong(self, supersample: int) -> None:
        wide = wider_intrinsics(CAMERA, supersample)
        distorted = distort_image(wide_picture(wide, 0.5 * supersample), wide, CAMERA)
        assert distorted.shape == (240, 320)
        # edges are curved here, which a corner of straight edges feels a little
        assert rms_at(distorted, CAMERA) < 0.01
        rectified = rectify_image(distorted, CAMERA, PINHOLE)
        assert rms_at(rectified, PINHOLE) < 0.005

    def test_an_ideal_lens_aliases_but_stays_within_two_hundredths(self) -> None:
        wide = wider_intrinsics(CAMERA, 2)
        distorted = distort_image(wide_picture(wide, 0.1), wide, CAMERA)
        assert rms_at(distorted, CAMERA) < 0.012
        assert rms_at(rectify_image(distorted, CAMERA, PINHOLE), PINHOLE) < 0.02

    def test_blur_distortion_and_noise_in_one_go(self) -> None:
        wide = wider_intrinsics(CAMERA, 2)
        light = wide_picture(wide, 0.1) / 255
        sensor = Sensor(blur_px=0.5, full_well_e=20000, vignetting=0.2, distortion=LENS)
        seen = optics(light, sensor, wide=wide, camera=CAMERA, supersample=2)
        assert seen.shape == (240, 320)
        assert rms_at(digitise(seen, sensor, np.random.default_rng(0)), CAMERA) < 0.015
        with pytest.raises(InvalidRig, match="give both the wide camera"):
            optics(light, sensor, wide=wide)

    def test_a_wrong_calibration_shows(self) -> None:
        wide = wider_intrinsics(CAMERA, 2)
        distorted = distort_image(wide_picture(wide, 1.0), wide, CAMERA)
        wrong = replace(CAMERA, lens=replace(LENS, k1=-0.24))
        assert 0.05 < rms_at(rectify_image(distorted, wrong, PINHOLE), PINHOLE) < 1.0
        shifted = replace(CAMERA, cx=CAMERA.cx + 0.5)
        assert 0.2 < rms_at(rectify_image(distorted, shifted, PINHOLE), PINHOLE) < 0.6

    def test_without_distortion_the_fine_pixels_are_averaged(self) -> None:
        wide = wider_intrinsics(PINHOLE, 2, margin_px=4)
        picture = np.random.default_rng(0).uniform(size=(wide.height, wide.width))
        left, top = (round(2 * PINHOLE.cx + 0.5 - wide.cx), round(2 * PINHOLE.cy + 0.5 - wide.cy))
        box = picture[-top : 480 - top, -left : 640 - left].reshape(240, 2, 320, 2).mean(axis=(1, 3))
        np.testing.assert_allclose(distort_image(picture, wide, PINHOLE), box, atol=1e-12)

    def test_rectifying_with_nothing_to_rectify_changes_nothing(self) -> None:
        image = np.random.default_rng(0).uniform(size=(240, 320, 3))
        np.testing.assert_allclose(rectify_image(image, PINHOLE, PINHOLE), image, atol=1e-9)

    @pytest.mark.parametrize("supersample", [1, 2, 4])
    def test_the_wider_camera_sees_the_same_rays(self, supersample: int) -> None:
        wide = wider_intrinsics(CAMERA, supersample)
        assert wide.lens is None
        rim = np.array([[-0.5, -0.5], [319.5, -0.5], [319.5, 239.5], [-0.5, 239.5], [160, -0.5], [-0.5, 120]])
        ideal = CAMERA.normalize(rim)
        seen = wide.denormalize(ideal)
        assert (seen > 2 * supersample).all()
        assert (seen < (wide.width - 2 * supersample, wide.height - 2 * supersample)).all()
        # the coarse pixel's middle is the middle of its k x k fine ones
        k = supersample
        coarse = (seen - (k - 1) / 2) / k
        np.testing.assert_allclose(np.diff(coarse, axis=0), np.diff(PINHOLE.denormalize(ideal), axis=0))
        offset = coarse - PINHOLE.denormalize(ideal)
        np.testing.assert_allclose(offset, np.round(offset), atol=1e-9)

    def test_barrel_needs_more_and_pincushion_less(self) -> None:
        barrel = wider_intrinsics(CAMERA, 1)
        pincushion = wider_intrinsics(replace(CAMERA, lens=BrownConrady(0.2)), 1)
        plain = wider_intrinsics(PINHOLE, 1)
        assert barrel.width > plain.width > pincushion.width

    def test_what_cannot_be_rendered_says_so(self) -> None:
        folded = replace(CAMERA, lens=BrownConrady(-1.2))
        with pytest.raises(InvalidRig, match="distortion folds within the picture"):
            wider_intrinsics(folded)
        with pytest.raises(InvalidRig, match="supersample 0: must be a whole number >= 1"):
            wider_intrinsics(CAMERA, 0)
        with pytest.raises(InvalidRig, match="at most 3 times as wide"):
            wider_intrinsics(PINHOLE, 1, margin_px=400)
        with pytest.raises(InvalidRig, match="does not cover the distorted one"):
            distort_image(np.zeros((240, 320)), PINHOLE, CAMERA)
        with pytest.raises(InvalidImage, match=r"wide image of shape \(3, 4\)"):
            distort_image(np.zeros((3, 4)), wider_intrinsics(CAMERA), CAMERA)
        with pytest.raises(InvalidImage, match=r"image of shape \(3, 4\): the camera has 240 rows and 320"):
            rectify_image(np.zeros((3, 4)), CAMERA, PINHOLE)
