"""A browser, and pages of the documentation's devices, as fixtures."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.vibralign.explorer.browser import Page, browser, find_browser
from vibralign.commands import main as cli

DOCS = Path(__file__).parents[3] / "docs"
DEVICES = ("devices/shaft", "devices/pin", "peg")


@pytest.fixture(scope="module")
def device_urls(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Pages of the documentation's devices, by name."""
    found, folder = {}, tmp_path_factory.mktemp("devices")
    for name in DEVICES:
        file = folder / f"{Path(name).stem}.html"
        device = ["--device", str(DOCS / f"{name}.yaml")]
        assert cli.main(["explore", *device, "--out", str(file)]) == 0
        found[file.stem] = file.as_uri()
    return found


@pytest.fixture(scope="module")
def started() -> Iterator[Page]:
    with browser(str(find_browser())) as page:
        yield page
