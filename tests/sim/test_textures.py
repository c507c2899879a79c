"""Textures: equal bits for equal words, seamless where they repeat, detail for a matcher, plain errors."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from rigsim.errors import InvalidScene
from rigsim.sim import noise
from rigsim.sim.scenes.textures import GENERATORS, apply_textures, generate
from rigsim.sim.truth import surfaces

SINGLE_PICTURES = {"amphora", "checker", "dial", "parcel", "poster", "ruler"}
SEAMLESS = sorted(set(GENERATORS) - SINGLE_PICTURES)
SEEDED = sorted(set(GENERATORS) - {"checker"})


def _row_steps(image: np.ndarray) -> np.ndarray:
    """Mean grey step from each row to the next; the last entry is the seam, from the last to the first."""
    gray = image.astype(float).mean(axis=2)
    return np.abs(np.roll(gray, -1, axis=0) - gray).mean(axis=1)


@pytest.mark.parametrize("name", sorted(GENERATORS))
def test_equal_words_give_equal_bits_and_a_read_only_picture(name: str) -> None:
    words = name if name == "checker" else f"{name} size=128 seed=7"
    first = generate(words)
    generate.cache_clear()
    second = generate(words)
    assert first is not second
    assert first.dtype == np.uint8
    assert first.ndim == 3
    assert first.shape[2] == 3
    assert np.array_equal(first, second)
    assert not first.flags.writeable


@pytest.mark.parametrize("name", SEEDED)
def test_another_seed_gives_another_picture(name: str) -> None:
    a, b = (generate(f"{name} size=128 seed={seed}").astype(int) for seed in (1, 2))
    assert np.abs(a - b).mean() > 1


@pytest.mark.parametrize("name", SEEDED)
def test_detail_at_the_texel_and_at_several_texels(name: str) -> None:
    gray = generate(f"{name} size=256 seed=3").astype(float).mean(axis=2)
    fine = np.abs(np.diff(gray, axis=1)).mean()
    coarse = np.abs(np.diff(gray.reshape(64, 4, 64, 4).mean(axis=(1, 3)), axis=1)).mean()
    least = 0.25 if name == "clouds" else 1.0  # a sky is soft
    assert fine > least
    assert coarse > least


@pytest.mark.parametrize("name", SEAMLESS)
@pytest.mark.parametrize("turn", [False, True])
def test_surfaces_have_no_seam(name: str, turn: bool) -> None:
    image = generate(f"{name} size=256 seed=5")
    steps = _row_steps(image.swapaxes(0, 1) if turn else image)
    assert steps[-1] <= 1.1 * steps[:-1].max()


def test_the_seam_check_sees_a_cut() -> None:
    steps = _row_steps(generate("clouds size=256 seed=5")[:160])
    assert steps[-1] > 3 * steps[:-1].max()


def test_value_noise_meets_its_lattice_and_wraps() -> None:
    lattice = np.random.default_rng(4).random((4, 8), dtype=np.float32) - np.float32(0.5)
    image = noise.value_noise(np.random.default_rng(4), (32, 64), (4, 8))
    np.testing.assert_array_equal(image[::8, ::8], lattice)
    # halfway between two lattice rows smoothstep is 1/2, the last cell leads back to the first row
    np.testing.assert_allclose(image[28, ::8], (lattice[3] + lattice[0]) / 2, atol=1e-7)
    np.testing.assert_allclose(image[::8, 60], (lattice[:, 7] + lattice[:, 0]) / 2, atol=1e-7)


def test_fractal_noise_is_standardised_and_stops_at_the_texel() -> None:
    image = noise.fractal(np.random.default_rng(0), (256, 256), (8, 8), 12)
    assert abs(image.mean()) < 0.2
    assert 0.7 < image.std() < 1.4


def test_cellular_noise_finds_the_two_nearest_seeds() -> None:
    rng = np.random.default_rng(2)
    y, x = (rng.random((6, 6), dtype=np.float32) for _ in range(2))
    y, x = np.arange(6)[:, None] + 0.5 + 0.8 * (y - 0.5), np.arange(6) + 0.5 + 0.8 * (x - 0.5)
    first, second, owner = noise.cellular(np.random.default_rng(2), (48, 48), (6, 6))
    row, col = 47, 1  # near a corner, so that the wrap counts
    dy, dx = np.abs(y - (row + 0.5) / 8), np.abs(x - (col + 0.5) / 8)
    distance = np.hypot(np.minimum(dy, 6 - dy), np.minimum(dx, 6 - dx)).ravel()
    nearest = np.argsort(distance)[:2]
    assert owner[row, col] == nearest[0]
    np.testing.assert_allclose([first[row, col], second[row, col]], distance[nearest], atol=1e-5)


def test_checker_edges_lie_between_texels_and_the_first_square_is_dark() -> None:
    image = generate("checker rows=2 cols=3 square=4 margin=2 dark=#000000 light=#ffffff")[..., 0]
    assert image.shape == (3 * 4 + 4, 4 * 4 + 4)
    assert set(np.unique(image)) == {0, 255}
    assert image[2, 2] == 0  # top left square
    assert image[2, 6] == 255
    assert image[1, 2] == image[2, 1] == 255  # margin
    # 3 x 4 squares: the pattern is turned into itself by half a turn with the tones swapped
    inner = image[2:-2, 2:-2]
    assert np.array_equal(inner, 255 - inner[::-1, ::-1])


def test_grain_runs_along_x() -> None:
    for name in ("wood", "metal"):
        gray = generate(f"{name} size=256 seed=1").astype(float).mean(axis=2)
        assert np.abs(np.diff(gray, axis=0)).mean() > 1.2 * np.abs(np.diff(gray, axis=1)).mean()


def test_width_and_height_are_not_mixed_up() -> None:
    assert generate("wood width=256 height=128 seed=1").shape == (128, 256, 3)


def test_colors_are_read_as_red_green_blue() -> None:
    np.testing.assert_allclose(surfaces.rgb("#ff8000"), [1.0, 128 / 255, 0.0], atol=1e-6)
    red, green, blue = generate("paint base=#e01020 wear=0 seed=1").reshape(-1, 3).mean(axis=0)
    assert red > 5 * blue > 5 * green * 0.9


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("", "unknown texture '': choose one of amphora"),
        ("velvet", "unknown texture 'velvet': choose one of amphora"),
        ("bark colour=#ffffff", "texture bark: unknown parameter 'colour', known are base"),
        ("bark base=brown", "texture bark: base=brown: must be a colour like #a08060"),
        ("bark size=100", "texture bark: size=100: must be a power of two from 64 to 2048"),
        ("bark size=4096", "texture bark: size=4096: must be a power of two from 64 to 2048"),
        ("bark size=1.5", "texture bark: size=1.5: must be a whole number"),
        ("bark seed=-1", "texture bark: seed=-1: must be >= 0"),
        ("bark seed=1 seed=2", "texture bark: seed is given twice"),
        ("bark ridges=7", "texture bark: ridges=7: must be a power of two from 1 to 64"),
        ("bricks rows=0", "texture bricks: rows=0: must be from 1"),
        ("plaster contrast=nan", "texture plaster: contrast=nan: must be from 0 to 4"),
        ("plaster contrast=much", "texture plaster: contrast=much: must be a number"),
        ("checker size=64", "texture checker: unknown parameter 'size'"),
        ("checker rows=4000 cols=4000", "texture checker: 128064x128064 texels, must be at most"),
        ("leaves count", "texture leaves: count=: must be a whole number"),
    ],
)
def test_bad_words_are_refused_in_one_line(words: str, message: str) -> None:
    with pytest.raises(InvalidScene) as caught:
        generate(words)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def _spec(text: str, kind: str = "2d", name: str = "t") -> mujoco.MjSpec:
    return mujoco.MjSpec.from_string(
        f"""<mujoco><custom><text name="texture:{name}" data="{text}"/><text name="other" data="x"/></custom>
        <asset><texture name="t" type="{kind}" builtin="flat" width="64" height="64" rgb1="1 0 0"/></asset>
        <worldbody><geom size="1"/></worldbody></mujoco>"""
    )


def test_pictures_end_up_in_the_model_row_0_first() -> None:
    spec = _spec("wood width=256 height=128 seed=3")
    apply_textures(spec)
    model = spec.compile()
    assert (model.tex_height[0], model.tex_width[0], model.tex_nchannel[0]) == (128, 256, 3)
    assert np.array_equal(model.tex_data.reshape(128, 256, 3), generate("wood width=256 height=128 seed=3"))
    assert model.tex_colorspace[0] == mujoco.mjtColorSpace.mjCOLORSPACE_LINEAR.value


def test_one_square_picture_serves_all_faces_of_a_cube() -> None:
    spec = _spec("wood size=128", kind="cube")
    apply_textures(spec)
    model = spec.compile()
    assert (model.tex_height[0], model.tex_width[0]) == (128, 128)
    assert model.tex_type[0] == mujoco.mjtTexture.mjTEXTURE_CUBE.value


def test_textures_that_do_not_fit_the_scene_are_refused() -> None:
    with pytest.raises(InvalidScene, match="texture 'u': described but not declared"):
        apply_textures(_spec("wood", name="u"))
    with pytest.raises(InvalidScene, match="256x128 texels on a cube, must be square"):
        apply_textures(_spec("wood width=256 height=128", kind="cube"))
    with pytest.raises(InvalidScene, match="unknown texture 'velvet'"):
        apply_textures(_spec("velvet"))
