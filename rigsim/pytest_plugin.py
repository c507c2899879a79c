"""The pytest plugin; nothing of rigsim is loaded before a test asks for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from rigsim.study.verify.case import Case
    from rigsim.testing import RenderedStereo

_FULL = "rigsim_full"
_QUICK = "rigsim_quick"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of the fixtures."""
    group = parser.getgroup("rigsim", "stereo triangulation held to known cases")
    group.addoption(
        "--rigsim-suite",
        choices=("quick", "full"),
        default="quick",
        help="cases of stereo_case and stereo_cases; full also runs the tests marked rigsim_full",
    )
    group.addoption("--rigsim-seed", type=int, default=0, help="seed of their points and noise")


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marks."""
    config.addinivalue_line("markers", f"{_QUICK}: runs with either suite of rigsim's cases")
    config.addinivalue_line("markers", f"{_FULL}: runs only with --rigsim-suite full")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave the tests of the full suite out of a quick run."""
    if config.getoption("--rigsim-suite") == "full":
        return
    skip = pytest.mark.skip(reason="runs with --rigsim-suite full")
    for item in items:
        if item.get_closest_marker(_FULL) and not item.get_closest_marker(_QUICK):
            item.add_marker(skip)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test a case, for tests that take ``stereo_case``."""
    if "stereo_case" in metafunc.fixturenames:
        cases = _cases(metafunc.config)
        metafunc.parametrize("stereo_case", cases, ids=[case.name.replace(" ", "-") for case in cases])


@pytest.fixture(scope="session")
def stereo_cases(request: pytest.FixtureRequest) -> list[Case]:
    """Every case of the suite that needs no scene: rig, pixels, and the true points."""
    return _cases(request.config)


@pytest.fixture(scope="session")
def rendered_stereo() -> Callable[..., RenderedStereo]:
    """`rigsim.testing.render_stereo`, which draws the same pair only once a session."""
    from functools import cache

    from rigsim.testing import render_stereo

    return cache(render_stereo)


def _cases(config: pytest.Config) -> list[Case]:
    from rigsim.testing import stereo_cases as cases

    return cases(suite=config.getoption("--rigsim-suite"), seed=config.getoption("--rigsim-seed"))
