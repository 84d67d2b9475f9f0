"""The explorer in a headless Firefox, from a file, by its Marionette protocol."""

import contextlib
import itertools
import json
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from model.runs.in_browser import module_for
from model.runs.simulate import simulate
from study.config import load_study, study_path
from study.explorer import study_model
from vibralign.explorer.page import build_page

PATH = shutil.which("firefox") or shutil.which("firefox-esr")
pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(
        PATH is None, reason="no Firefox is installed: the explorer is not tried in it"
    ),
]
STUDY = load_study(study_path())


class Firefox:
    """A window of Firefox."""

    def __init__(self, port: int) -> None:
        self._socket, self._numbers = self._connected(port), itertools.count(1)
        self._read()  # the greeting
        self.call("WebDriver:NewSession")

    @staticmethod
    def _connected(port: int) -> socket.socket:
        end = time.monotonic() + 60.0
        while True:
            try:
                return socket.create_connection(("127.0.0.1", port), 60.0)
            except OSError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.2)

    def _read(self) -> Any:
        length = b""
        while (byte := self._socket.recv(1)) != b":":
            assert byte, "Firefox ended"
            length += byte
        data = b""
        while len(data) < int(length):
            data += self._socket.recv(int(length) - len(data))
        return json.loads(data)

    def close(self) -> None:
        self._socket.close()

    def call(self, command: str, **parameters: Any) -> Any:
        message = json.dumps([0, next(self._numbers), command, parameters]).encode()
        self._socket.sendall(str(len(message)).encode() + b":" + message)
        _, _, error, result = self._read()
        assert error is None, error
        return result

    def evaluate(self, expression: str) -> Any:
        """Return the value of JavaScript in the page."""
        script = f"return window.eval({json.dumps(expression)});"
        return self.call("WebDriver:ExecuteScript", script=script, args=[], sandbox=None)["value"]

    def wait_for(self, condition: str, seconds: float = 120.0) -> None:
        """Wait until JavaScript is true."""
        end = time.monotonic() + seconds
        while not self.evaluate(f"Boolean({condition})"):
            assert time.monotonic() < end, condition
            time.sleep(0.05)


def _free_port() -> int:
    with contextlib.closing(socket.socket()) as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port


@pytest.fixture(scope="module")
def firefox(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Firefox]:
    profile, port = tmp_path_factory.mktemp("profile"), _free_port()
    (profile / "user.js").write_text(f'user_pref("marionette.port", {port});\n')
    command = [str(PATH), "--headless", "--marionette", "--no-remote", "--profile", str(profile)]
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        with contextlib.closing(Firefox(port)) as found:
            yield found
    finally:
        running.terminate()
        running.wait()


def test_opens_from_a_file_runs_and_maps(firefox: Firefox, tmp_path: Path) -> None:
    made, file = module_for(), tmp_path / "explorer.html"
    file.write_text(build_page(study_model(STUDY, made.interface), made), encoding="utf-8")
    firefox.call("WebDriver:Navigate", url=f"{file.as_uri()}#figure=fig05&t=1")
    firefox.wait_for("window.explorer && explorer.run")
    run = simulate(STUDY.parameters("fig05"), STUDY.settings.settings)
    time_there = firefox.evaluate("explorer.run.results.tau_align")
    assert time_there == pytest.approx(run.tau_align, abs=1e-8)
    assert firefox.evaluate("document.getElementById('verdict').textContent").startswith("Aligned")
    firefox.wait_for("explorer.measured.map")
    assert firefox.evaluate("explorer.map.outcome.every((each) => each >= 0)")
    before = firefox.evaluate("location.hash")
    firefox.evaluate(
        "(() => { const box = document.getElementById('p-press_force'); box.value = '4';"
        "box.dispatchEvent(new Event('change')); })()"
    )
    assert firefox.evaluate("location.hash") != before
    assert firefox.evaluate("explorer.run.results.tau_align") != time_there
