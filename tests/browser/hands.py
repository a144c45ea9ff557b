"""What a person does at the page with fingers, a gamepad or a turned phone."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from playwright.sync_api import CDPSession, Page

from tests.browser.support import until

T = TypeVar("T")
FAKE_PADS = """
window.fakePads = [];
window.polls = 0;
navigator.getGamepads = () => ((window.polls += 1), window.fakePads);
window.plugPad = (mapping, held = []) => {
  const buttons = Array.from({ length: 17 }, (_, n) => ({ pressed: held.includes(n), value: 0 }));
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
DEVICES = FAKE_PADS + FAKE_SENSOR
"""Scripts of a tab whose gamepad and sensor :class:`Hands` move."""
DEADMAN, TURBO, STOP, ESTOP, RESET = 4, 5, 1, 8, 9


@dataclass
class Hands:
    """Hands at a page.

    Attributes:
        page: The page.
        tools: The browser's own tools for it.
    """

    page: Page
    tools: CDPSession

    @property
    def source(self) -> str | None:
        """What the page drives with."""
        source: str | None = self.page.evaluate("(window.bench ?? window.pioneer3.state).source")
        return source

    def polled(self) -> None:
        """Wait until the page has read the gamepad: it does so 50 times a second."""
        before = self.page.evaluate("window.polls")
        until(lambda: bool(self.page.evaluate("window.polls") >= before + 2))

    def tell(self, event: str) -> None:
        """Let the window hear an event."""
        self.page.evaluate("(name) => { dispatchEvent(new Event(name)); }", event)

    def hide(self) -> None:
        """Put another tab in front."""
        self.page.evaluate("""() => {
            Object.defineProperty(document, "hidden", { value: true, configurable: true });
            document.dispatchEvent(new Event("visibilitychange"));
        }""")

    def touch(self, kind: str, *points: tuple[float, float]) -> None:
        """Tell where all fingers are now: touchStart, touchMove, touchEnd, touchCancel."""
        fingers = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
        self.tools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})

    def touch_until(self, press: Callable[[], T], moving: Callable[[], bool]) -> T:
        """Put a finger down by `press` until the robot is `moving`; return the answer of `press`.

        It is lifted and put down again where the page refuses it or lets go: see `support.hold`.
        """
        answers: list[T] = []

        def held() -> bool:
            if self.source is None:
                if answers:
                    self.touch("touchEnd")
                answers.append(press())
            return moving()

        until(held)
        return answers[-1]

    def push_until(
        self, forward: float, moving: Callable[[], bool], left: float = 0.0
    ) -> tuple[float, float]:
        """Push the stick until the robot is `moving`; return where the finger is."""
        return self.touch_until(lambda: self.push(forward, left), moving)

    def middle(self, selector: str) -> tuple[float, float]:
        """Return the middle of an element."""
        box = self.page.locator(selector).bounding_box()
        assert box is not None
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def push(self, forward: float, left: float = 0.0) -> tuple[float, float]:
        """Put a finger on the stick and move it, in parts of all the way; return where it is."""
        x, y = self.middle("#stick")
        box = self.page.locator("#stick").bounding_box()
        assert box is not None
        reach = 0.36 * min(box["width"], box["height"])
        self.touch("touchStart", (x, y))
        self.touch("touchMove", (x - left * reach, y - forward * reach))
        return x - left * reach, y - forward * reach

    def plug(self, mapping: str = "standard", *held: int) -> None:
        """Plug a gamepad in, with buttons that are held."""
        self.page.evaluate("(pad) => window.plugPad(...pad)", [mapping, list(held)])

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
        self.polled()

    def stick(self, x: float, y: float) -> None:
        """Move the left stick: x to the right, y down."""
        self.page.evaluate("(axes) => { window.fakePads[0].axes = [...axes, 0, 0]; }", [x, y])
        self.polled()

    def turn_phone(self, *angles: float) -> None:
        """Hold the phone so from now on: alpha, beta, gamma [degrees]; none silences its sensor."""
        self.page.evaluate("(angles) => window.turnPhone(angles)", angles)
