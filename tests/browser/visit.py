"""A visit to the page by somebody with a phone or a gamepad, and the requests that it sends."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from playwright.sync_api import WebSocket

from tests.browser.hands import DEVICES, Hands
from tests.browser.support import until, wait_for_the_robot
from tests.browser.tabs import DESKTOP, Size, Tabs, no_complaints


@dataclass
class Visit(Hands):
    """A page, and what it sends.

    Attributes:
        sent: Every request so far.
    """

    sent: list[dict[str, Any]] = field(default_factory=list)

    def listen(self, socket: WebSocket) -> None:
        """Keep what this socket sends."""
        socket.on("framesent", lambda text: self.sent.append(json.loads(text)))

    def drives(self) -> list[dict[str, Any]]:
        """Return what was sent about driving so far, stops included, to the only robot."""
        self.page.evaluate("0")  # what was sent before is told by then
        asked = [dict(m) for m in self.sent if m["type"] in {"drive", "stop"}]
        assert {m.pop("robot") for m in asked} <= {1}
        return asked

    def sends_zeros(self, source: str) -> None:
        """Wait for the three zeros of a release."""
        zeros = [{"type": "drive", "v": 0, "w": 0, "input": source}] * 3
        until(lambda: self.drives()[-3:] == zeros)


@contextmanager
def visit(tabs: Tabs, url: str, *, size: Size = DESKTOP, phone: bool = False) -> Iterator[Visit]:
    """Open the page with a gamepad socket; anything in the console fails the test."""
    with (
        tabs.open(size=size, touch=phone, mobile=phone, scripts=DEVICES) as page,
        no_complaints(page),
    ):
        there = Visit(page, page.context.new_cdp_session(page))
        page.on("websocket", there.listen)
        page.goto(url)
        wait_for_the_robot(page)
        yield there
        page.remove_listener("websocket", there.listen)
        there.tools.detach()
