"""A headless Chromium, driven by its DevTools protocol through a pipe, with a page to test."""

import base64
import contextlib
import itertools
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


def find_browser() -> str | None:
    """Return the path of a Chromium, or the one that ``CHROMIUM`` names; None if there is none."""
    named = os.environ.get("CHROMIUM")
    found = (shutil.which(each) for each in ([named] if named else BROWSERS))
    return next(filter(None, found), None)


# The browser reads messages from descriptor 3, and writes them to 4.
_START = """
import fcntl, os, sys
read, write = (fcntl.fcntl(int(each), fcntl.F_DUPFD, 10) for each in sys.argv[1:3])
os.dup2(read, 3)
os.dup2(write, 4)
os.execv(sys.argv[3], sys.argv[3:])
"""


class Page:
    """A page in the browser.

    Attributes:
        errors: exceptions and error messages of the page's console so far.
    """

    def __init__(self, read: Any, write: Any) -> None:
        self._read, self._write, self._numbers = read, write, itertools.count(1)
        self._session: str | None = None
        self._loaded = False
        self.errors: list[str] = []
        target = self._call("Target.createTarget", url="about:blank")["targetId"]
        attached = self._call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self._call(f"{domain}.enable")

    def _call(self, method: str, **params: Any) -> dict[str, Any]:
        number = next(self._numbers)
        message: dict[str, Any] = {"id": number, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        self._write.write(json.dumps(message).encode() + b"\0")
        self._write.flush()
        while (answer := self._next()).get("id") != number:
            pass
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        result: dict[str, Any] = answer["result"]
        return result

    def _next(self) -> dict[str, Any]:
        """Return the browser's next message, and note what it says of the page."""
        text = bytearray()
        while (byte := self._read.read(1)) != b"\0":
            if not byte:
                raise RuntimeError("the browser ended")
            text += byte
        message: dict[str, Any] = json.loads(text)
        method, params = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning"):
            self.errors.append(" ".join(str(each.get("value")) for each in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            self.errors.append(params["entry"]["text"])
        elif method == "Page.loadEventFired":
            self._loaded = True
        return message

    def open(self, url: str, width: int = 1280, height: int = 900) -> None:
        """Load a page in a window of this size, in pixels."""
        self._call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                   deviceScaleFactor=1, mobile=False)  # fmt: skip
        self._call("Page.navigate", url="about:blank")
        self._loaded = False
        self._call("Page.navigate", url=url)
        while not self._loaded:
            self._next()

    def scripts(self, allowed: bool) -> None:
        """Switch the scripts of pages on or off, those of ``evaluate`` apart."""
        self._call("Emulation.setScriptExecutionDisabled", value=not allowed)

    @contextlib.contextmanager
    def beginning_with(self, script: str) -> Iterator[None]:
        """Run ``script`` before those of every page that is opened in the block."""
        added = self._call("Page.addScriptToEvaluateOnNewDocument", source=script)
        try:
            yield
        finally:
            self._call("Page.removeScriptToEvaluateOnNewDocument", identifier=added["identifier"])

    def evaluate(self, expression: str) -> Any:
        """Return the value of JavaScript in the page, after its promise is kept.

        Raises:
            RuntimeError: it throws.
        """
        done = self._call("Runtime.evaluate", expression=expression, awaitPromise=True,
                          returnByValue=True)  # fmt: skip
        if "exceptionDetails" in done:
            raise RuntimeError(done["exceptionDetails"]["exception"]["description"])
        return done["result"].get("value")

    def wait_for(self, condition: str, seconds: float = 30.0) -> None:
        """Wait until JavaScript is true.

        Raises:
            RuntimeError: it is not within ``seconds``.
        """
        tries = f"""new Promise((yes, no) => {{ const end = performance.now() + {1e3 * seconds};
            const look = () => ({condition}) ? yes() : performance.now() > end
                ? no(new Error("not within {seconds} s: " + {json.dumps(condition)}))
                : setTimeout(look, 20);
            look(); }})"""
        self.evaluate(tries)

    def show(self, url: str, width: int = 1280, height: int = 900) -> None:
        """Open a page of the explorer, and wait until it shows a run."""
        self.open(url, width, height)
        self.wait_for("window.explorer && explorer.run")

    def text(self, name: str) -> str:
        """Return the text of the element ``name``."""
        return str(self.evaluate(f"document.getElementById({json.dumps(name)}).textContent"))

    @property
    def address(self) -> str:
        """Part of the address after its #, once it is that of the state: it follows the answer."""
        self.wait_for("location.hash === hashOf(state, MODEL)")
        return str(self.evaluate("location.hash"))

    @property
    def results(self) -> dict[str, Any]:
        """Results of the run that is shown."""
        found: dict[str, Any] = self.evaluate("explorer.run.results")
        return found

    def set(self, name: str, value: object, event: str) -> None:
        """Give a control a value, as a reader does."""
        self.evaluate(
            f"(() => {{ const it = document.getElementById('{name}'); it.value = '{value}';"
            f"it.dispatchEvent(new Event('{event}', {{bubbles: true}})); }})()"
        )

    def slide(self, name: str, value: float) -> None:
        """Move the slider of a parameter."""
        self.set(f"s-{name}", value, "input")

    def type_in(self, name: str, value: str) -> None:
        """Type into the field of a parameter."""
        self.set(f"p-{name}", value, "change")

    def prefer_reduced_motion(self) -> None:
        """Make pages see a reader who prefers reduced motion."""
        wish = {"name": "prefers-reduced-motion", "value": "reduce"}
        self._call("Emulation.setEmulatedMedia", features=[wish])

    def press(self, key: str, code: int) -> None:
        """Press and release a key, such as "ArrowRight" with its code 39."""
        for kind in ("keyDown", "keyUp"):
            text = key if len(key) == 1 and kind == "keyDown" else ""
            self._call("Input.dispatchKeyEvent", type=kind, key=key, code=key, text=text,
                       windowsVirtualKeyCode=code)  # fmt: skip

    def click(self, x: float, y: float) -> None:
        """Click at a place of the window, in pixels."""
        for kind in ("mousePressed", "mouseReleased"):
            self._call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left",
                       buttons=1, clickCount=1)  # fmt: skip

    @contextlib.contextmanager
    def touched(self) -> Iterator[None]:
        """Give the window a screen that is touched, in the block."""
        self._call("Emulation.setTouchEmulationEnabled", enabled=True)
        try:
            yield
        finally:
            self._call("Emulation.setTouchEmulationEnabled", enabled=False)

    def swipe(self, x: float, y: float, up: float) -> None:
        """Move a finger from a place of the window upwards, in pixels, as slowly as one scrolls."""
        self._touch("touchStart", x, y)
        for part in range(1, 16):
            self._touch("touchMove", x, y - up * part / 15)
            self.evaluate("new Promise((done) => requestAnimationFrame(done))")
        self._touch("touchEnd")
        self.evaluate("new Promise((done) => setTimeout(done, 100))")

    def tap(self, x: float, y: float) -> None:
        """Tap at a place of the window, in pixels."""
        self._touch("touchStart", x, y)
        self._touch("touchEnd")
        self.evaluate("new Promise((done) => setTimeout(done, 100))")

    def _touch(self, kind: str, *place: float) -> None:
        points = [dict(zip("xy", place, strict=True))] if place else []
        self._call("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    def picture(self, whole: bool = False) -> bytes:
        """Return the window, or the whole page, as PNG."""
        shot = self._call("Page.captureScreenshot", captureBeyondViewport=whole)
        return base64.b64decode(shot["data"])


@contextlib.contextmanager
def browser(path: str) -> Iterator[Page]:
    """Start the browser at ``path`` with one page, and end it."""
    to_read, to_write = os.pipe(), os.pipe()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [
            sys.executable, "-c", _START, str(to_read[0]), str(to_write[1]), path, "--headless",
            "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run",
            "--remote-debugging-pipe", f"--user-data-dir={Path(profile)}",
        ]  # fmt: skip
        running = subprocess.Popen(
            command, pass_fds=(to_read[0], to_write[1]), stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(to_read[0])
        os.close(to_write[1])
        try:
            with open(to_read[1], "wb") as write, open(to_write[0], "rb") as read:  # noqa: PTH123
                yield Page(read, write)
        finally:
            running.terminate()
            running.wait()
