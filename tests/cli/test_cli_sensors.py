"""Sensors on the command line: which one is taken, what it is called, and what is listed and documented."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from rigsim.api.kit.sensors import SensorOptions, sensor_labels
from rigsim.cli.app import run
from rigsim.cli.kit.sensors import sensor_words
from rigsim.errors import InvalidRange, InvalidRig, RigsimError
from rigsim.interop.formats.rig_toml import parse_rig, parse_sensor
from rigsim.rig.catalogue.sensors import SENSORS, SensorPreset
from rigsim.rig.sensor import Sensor

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "reference" / "sensors.md").read_text(encoding="utf-8")
RIG = "baseline_mm = 120\nwidth_px = 1280\nheight_px = 720\nfocal_px = 900\n"


def sensors_from(name: str | None = None, rig: Path | None = None, **words: Any) -> tuple[Sensor, ...]:
    return SensorOptions(**sensor_words(name, rig, **words)).all()


def sensor_from(name: str | None = None, rig: Path | None = None, **words: Any) -> Sensor:
    return SensorOptions(**sensor_words(name, rig, **words)).one()


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    path = tmp_path / "rig.toml"
    path.write_text(RIG + '[sensor]\nname = "IMX250"\nblur_px = 0.8\n', encoding="utf-8")
    return path


def test_without_words_the_sensor_is_ideal(tmp_path: Path) -> None:
    assert sensor_from() == Sensor()
    plain = tmp_path / "plain.toml"
    plain.write_text(RIG, encoding="utf-8")
    assert sensors_from(None, plain) == (Sensor(),)
    # Middlebury's calibration knows no sensor
    calib = tmp_path / "calib.txt"
    calib.write_text(
        "cam0=[500 0 320; 0 500 240; 0 0 1]\ncam1=[500 0 320; 0 500 240; 0 0 1]\n"
        "doffs=0\nbaseline=100\nwidth=640\nheight=480\n",
        encoding="utf-8",
    )
    assert sensor_from(None, calib) == Sensor()


def test_the_rig_has_its_own_sensor_and_a_name_wins_over_all_of_it(rig: Path) -> None:
    assert sensor_from(None, rig) == Sensor(blur_px=0.8, full_well_e=10715.0, read_noise_e=2.4, bits=12)
    assert sensor_from("imx249", rig) == Sensor(full_well_e=32359.0, read_noise_e=6.73, bits=12)
    assert sensor_from("IMX249") == sensor_from("imx249")


def test_options_change_single_numbers(rig: Path) -> None:
    changed = sensor_from(None, rig, blur="0.5px", image_noise="2", full_well="9e3", read_noise="4e")
    assert changed == Sensor(blur_px=0.5, full_well_e=9000.0, read_noise_e=4.0, grey_noise=2.0, bits=12)
    named = sensor_from("imx477", rig, blur="0.5", full_well="9000")
    assert named == Sensor(blur_px=0.5, full_well_e=9000.0, read_noise_e=3.0, bits=12)
    assert sensor_from("imx219", full_well="4700", read_noise="0") == Sensor(full_well_e=4700.0, bits=10)
    assert sensor_from(blur="0") == Sensor()


def test_levels_of_image_noise_are_sensors_that_share_their_optics(rig: Path) -> None:
    levels = sensors_from(None, rig, image_noise="0,1.5,3")
    assert [sensor.grey_noise for sensor in levels] == [0.0, 1.5, 3.0]
    assert {sensor.blur_px for sensor in levels} == {0.8}
    with pytest.raises(InvalidRange, match="image noise 0,1: 2 levels; this command takes one"):
        sensor_from(image_noise="0,1")


def test_labels_are_short_and_say_what_differs() -> None:
    assert sensor_labels(sensors_from(image_noise="0,2")) == ("ideal", "ideal, 2 grey")
    assert sensor_labels(sensors_from("imx477")) == ("IMX477",)
    assert sensor_labels([SENSORS["imx250"].sensor(bits=8, gain=2)]) == ("IMX250, 8 bit, gain 2",)
    assert sensor_labels([SENSORS["ov5647"].sensor(read_noise_e=4)]) == ("OV5647, read noise 4 e-",)
    assert sensor_labels([Sensor(full_well_e=9000, bits=0)]) == ("no rounding, full well 9000 e-",)
    # IMX265, IMX304 and IMX392 have the same pixels: nothing in the electrons says which it is
    siblings = "12 bit, full well 10400 e-, read noise 2.1 e-"
    assert sensor_labels([SENSORS["imx304"].sensor()]) == (siblings,)
    assert sensor_labels([SENSORS["imx304"].sensor()], "imx304") == ("IMX304",)
    given = sensors_from("IMX296", full_well="10000", read_noise="2.5", blur="0.7")
    assert sensor_labels(given, "IMX296") == ("IMX296, full well 10000 e-, read noise 2.5 e-, blur 0.7 px",)
    assert sensor_labels(given) == ("10 bit, full well 10000 e-, read noise 2.5 e-, blur 0.7 px",)
    assert sensor_labels([Sensor(right_gain=1.1, right_offset=0.02, vignetting=0.3)]) == (
        "ideal, vignetting 0.3, right gain 1.1, right offset 0.02",
    )


def test_labels_of_levels_never_coincide() -> None:
    for words in ("0:2/7", "1,1.00000001", "0,1e-9,2e-9"):
        levels = sensors_from(image_noise=words)
        assert len(set(sensor_labels(levels))) == len(levels)
    assert sensor_labels(sensors_from(image_noise="0:1/4"))[1] == "ideal, 0.3333 grey"


@pytest.mark.parametrize(
    ("words", "error", "message"),
    [
        ({"name": "kodak"}, InvalidRig, "unknown sensor 'kodak': choose one of imx219, imx296, imx477"),
        (
            {"name": "IMX296"},
            InvalidRig,
            "imx296: no source was found for its full well and read noise; add --full-well and --read-noise",
        ),
        ({"name": "IMX296", "full_well": "9000"}, InvalidRig, "its read noise; add --read-noise in"),
        ({"name": "OV5647"}, InvalidRig, "sensor ov5647: no source was found for its read noise; add --read"),
        ({"blur": "-1"}, InvalidRange, "lens blur -1 px: must be >= 0"),
        ({"blur": "nan"}, InvalidRange, "lens blur nan: must be a finite number"),
        ({"blur": "0.5,1"}, InvalidRange, "lens blur 0.5,1: must be a number"),
        ({"blur": "1mm"}, InvalidRange, "lens blur 1mm: unknown unit 'mm'"),
        ({"image_noise": "1,-2"}, InvalidRange, "image noise -2 grey: must be >= 0"),
        ({"image_noise": "1,1"}, InvalidRange, "is given twice"),
        ({"image_noise": ""}, InvalidRange, "image noise empty"),
        ({"full_well": "-5"}, InvalidRange, "full well -5 e: must be >= 0"),
        ({"read_noise": "3"}, InvalidRig, "read noise 3 e- without a full well"),
    ],
)
def test_slips_are_one_line(words: dict[str, Any], error: type[RigsimError], message: str) -> None:
    with pytest.raises(error) as raised:
        sensors_from(**words)
    assert message in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_slip_in_the_rigs_sensor_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(RIG + "[sensor]\nbits = 9", encoding="utf-8")
    with pytest.raises(
        InvalidRig, match=re.escape(f"{path}: sensor.bits 9: must be one of 0, 8, 10, 12, 16")
    ):
        sensor_from(None, path)


def shown(value: float | None) -> str:
    return "–" if value is None else f"{value:g}"


def test_scenes_lists_every_sensor_within_80_columns(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert run(["scenes"]) == 0
    listed = capsys.readouterr().out
    assert max(map(len, listed.splitlines())) <= 80
    table, sources = listed.partition("Sensors (--sensor)")[2].split("Sources\n")
    rows = {line.split()[0]: line.split() for line in table.splitlines() if line[:1].islower()}
    words = " ".join(sources.split())
    for preset in SENSORS.values():
        assert rows[preset.name] == [
            preset.name,
            preset.maker,
            shown(preset.pitch_um),
            f"{preset.width}x{preset.height}",
            preset.shutter or "–",
            str(preset.bits),
            shown(preset.full_well_e),
            shown(preset.read_noise_e),
        ]
        assert f"{preset.name} {preset.geometry_source}" in words
        assert preset.noise_source in words
        assert preset.shutter_source in words


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


@pytest.mark.parametrize("preset", SENSORS.values(), ids=lambda preset: preset.name)
def test_the_page_holds_every_sensor_as_it_is(preset: SensorPreset) -> None:
    (row,) = (cells(line) for line in PAGE.splitlines() if line.startswith(f"| {preset.name.upper()} "))
    assert row == [
        preset.name.upper(),
        preset.maker,
        shown(preset.pitch_um),
        f"{preset.width}x{preset.height}",
        preset.shutter or "–",
        str(preset.bits),
        shown(preset.full_well_e),
        shown(preset.read_noise_e),
        preset.geometry_source,
        preset.noise_source or "–",
        "that of pixel and image"
        if preset.shutter_source == preset.geometry_source
        else preset.shutter_source,
        "–"
        if preset.housing is None
        else f"{shown(preset.housing.width_mm)} mm, {preset.housing.camera} ({preset.housing.source})",
    ]


def test_the_page_holds_no_other_sensor_and_every_key_with_its_ideal() -> None:
    table = PAGE.partition("## Known by name")[2].partition("## In rig.toml")[0]
    listed = [cells(line)[0].lower() for line in table.splitlines() if line.startswith("| ")][1:]
    assert listed == list(SENSORS)
    keys = PAGE.partition("| key |")[2].partition("## On the")[0]
    ideal = dict(re.findall(r"^\| `(\w+)` \| ([\w.]+) \|", keys, re.MULTILINE))
    expected = {field.name: getattr(Sensor(), field.name) for field in fields(Sensor)}
    assert ideal == {key: "none" if value is None else f"{value:g}" for key, value in expected.items()}


def test_the_pages_example_reads_and_its_numbers_are_right() -> None:
    (example,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    sensor = parse_sensor(RIG + example)
    assert sensor is not None
    assert (sensor.blur_px, sensor.gain, sensor.full_well_e) == (0.6, 2.0, 8180.0)
    assert sensor.distortion is not None
    assert sensor.distortion.k1 == -0.05
    assert parse_rig(RIG + example) == parse_rig(RIG)
    assert "4090 electrons with 64 of noise: 2.0 of 255 grey levels, a signal 64 times its noise" in PAGE
    half = sensor_from("imx477")
    noise_grey = float(half.noise_std(half.full_scale / 2)) / half.full_scale * 255
    assert noise_grey == pytest.approx(2.0, abs=0.05)
    assert 4090 / (noise_grey / 255 * 8180) == pytest.approx(64, abs=0.5)
