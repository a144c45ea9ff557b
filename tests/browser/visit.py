"""A visit to the page: fingers, gamepads and turned phones, and the requests that it sends."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from playwright.sync_api import Browser, Page, ViewportSize, WebSocket

from tests.browser.support import until, wait_for_the_robot

FAKE_PADS = """
window.fakePads = [];
window.polls = 0;
navigator.getGamepads = () => ((window.polls += 1), window.fakePads);
window.plugPad = (mapping) => {
  const buttons = Array.from({ length: 17 }, () => ({ pressed: false, value: 0 }));
  const axes = [0, 0, 0, 0];
  window.fakePads = [{ index: 0, id: "Test Pad", mapping, connected: true, axes, buttons }];
  dispatchEvent(new Event("gamepadconnected"));
};
"""
FAKE_SENSOR = """
window.turnPhone = (angles) => {
  clearInterval(window.sensor);
  const [alpha, beta, gamma] = angles;
  const init = { alpha, beta, gamma };
  const tell = () => dispatchEvent(new DeviceOrientationEvent("deviceorientation", init));
  if (angles.length > 0) window.sensor = setInterval(tell, 20);
};
"""
DEADMAN, TURBO, STOP, ESTOP, RESET = 4, 5, 1, 8, 9


@dataclass
class Visit:
    """A page, its console, and what it sends.

    Attributes:
        sent: Every request so far.
        complaints: What stood in the console.
    """

    page: Page
    sent: list[dict[str, Any]] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("websocket", self._listen)

    def _listen(self, socket: WebSocket) -> None:
        socket.on("framesent", lambda text: self.sent.append(json.loads(text)))

    def drives(self) -> list[dict[str, Any]]:
        """Return what was sent about driving so far, stops included, to the only robot."""
        self.page.wait_for_timeout(1)  # so that what was sent is told
        asked = [dict(m) for m in self.sent if m["type"] in {"drive", "stop"}]
        assert {m.pop("robot") for m in asked} <= {1}
        return asked

    def sends_zeros(self, source: str) -> None:
        """Wait for the three zeros of a release."""
        zeros = [{"type": "drive", "v": 0, "w": 0, "input": source}] * 3
        until(lambda: self.drives()[-3:] == zeros)

    def rate(self) -> float:
        """Return how many requests about driving are sent in a second, measured for one."""
        clock, before = "performance.now() / 1000", len(self.drives())
        began = self.page.evaluate(clock)
        self.page.wait_for_timeout(1000)
        took: float = self.page.evaluate(clock) - began
        return (len(self.drives()) - before) / took

    @property
    def source(self) -> str | None:
        """What the page drives with."""
        source: str | None = self.page.evaluate("window.pioneer3.state.source")
        return source

    def touch(self, kind: str, *points: tuple[float, float]) -> None:
        """Tell where all fingers are now: touchStart, touchMove, touchEnd, touchCancel."""
        if not hasattr(self, "_cdp"):
            self._cdp = self.page.context.new_cdp_session(self.page)
        fingers = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
        self._cdp.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})

    def middle(self, selector: str) -> tuple[float, float]:
        """Return the middle of an element."""
        box = self.page.locator(selector).bounding_box()
        assert box is not None
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def plug(self, mapping: str = "standard") -> None:
        """Plug a gamepad in."""
        self.page.evaluate("(mapping) => window.plugPad(mapping)", mapping)

    def unplug(self, event: bool = True) -> None:
        """Pull the gamepad out; browsers tell of it, or only show it no more."""
        self.page.evaluate(
            "(event) => { window.fakePads = [null];"
            " if (event) dispatchEvent(new Event('gamepaddisconnected')); }",
            event,
        )

    def button(self, *numbers: int, pressed: bool = True) -> None:
        """Press or let go of buttons of the gamepad."""
        self.page.evaluate(
            "([numbers, pressed]) =>"
            " numbers.forEach((n) => (window.fakePads[0].buttons[n].pressed = pressed))",
            [numbers, pressed],
        )
        self._polled()

    def stick(self, x: float, y: float) -> None:
        """Move the left stick: x to the right, y down."""
        self.page.evaluate("(axes) => (window.fakePads[0].axes = [...axes, 0, 0])", [x, y])
        self._polled()

    def _polled(self) -> None:
        """Wait until the page has read the gamepad: it does so 50 times a second."""
        before = self.page.evaluate("window.polls")
        until(lambda: bool(self.page.evaluate("window.polls") >= before + 2))

    def turn_phone(self, *angles: float) -> None:
        """Hold the phone so from now on: alpha, beta, gamma [degrees]; none silences its sensor."""
        self.page.evaluate("(angles) => window.turnPhone(angles)", angles)


@contextmanager
def visit(
    browser: Browser, url: str, *, size: tuple[int, int] = (1440, 900), phone: bool = False
) -> Iterator[Visit]:
    """Open the page with a gamepad socket; anything in the console fails the test."""
    viewport: ViewportSize = {"width": size[0], "height": size[1]}
    context = browser.new_context(viewport=viewport, has_touch=phone, is_mobile=phone)
    context.add_init_script(FAKE_PADS + FAKE_SENSOR)
    there = Visit(context.new_page())
    there.page.goto(url)
    wait_for_the_robot(there.page)
    yield there
    assert there.complaints == []
    context.close()
