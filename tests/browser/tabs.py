"""Tabs of Chromium that one test after another uses: to open a new one costs more than most tests.

What has been loaded and compiled stays; all else is emptied: storage, cookies, held keys, the page.
"""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Literal

from playwright.sync_api import Browser, CDPSession, ConsoleMessage, Error, Page

Size = tuple[int, int]
DESKTOP: Size = (1210, 700)
"""The smallest with all that a desktop has: the processor draws it."""
PHONE: Size = (390, 844)
HELD = ("ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight", "Shift", "Control", "k", "w", "a")
"""Keys that tests hold."""
SLOW_DISPLAY = """{
  const real = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (draw) => setTimeout(() => real(draw), 25);
  window.cancelAnimationFrame = (id) => clearTimeout(id);
}
"""
"""A display of some 25 pictures a second: to draw 60 without graphics takes half of a processor."""
EMPTIED = "cookies,local_storage,indexeddb,service_workers,cache_storage"
OF_THE_RENDERER = "GL Driver Message"
"""Part of the console's warnings that WebGL by the processor reads pixels slowly."""


@dataclass(frozen=True)
class Kind:
    """What a context cannot change once it is open."""

    touch: bool
    mobile: bool
    scripts: str


@dataclass
class Tabs:
    """Lends the tabs of one connection to Chromium; tabs that are lent at once share nothing."""

    browser: Browser
    _free: dict[Kind, list[Page]] = field(default_factory=dict)

    @contextmanager
    def open(
        self,
        url: str = "",
        *,
        size: Size = (1280, 720),
        touch: bool = False,
        mobile: bool = False,
        scheme: Literal["dark", "light"] = "light",
        scripts: str = "",
    ) -> Iterator[Page]:
        """Open `url` in a tab of its own context.

        Args:
            url: What to open; nothing opens an empty tab.
            size: Its inside [CSS px].
            touch: Whether it feels fingers.
            mobile: Whether it is a phone's.
            scheme: The colours that its user prefers.
            scripts: What runs before those of every page in it.
        """
        kind = Kind(touch, mobile, scripts)
        free = self._free.setdefault(kind, [])
        page = free.pop() if free else self._new(kind)
        page.set_viewport_size({"width": size[0], "height": size[1]})
        page.emulate_media(color_scheme=scheme)
        try:
            if url:
                page.goto(url)
            yield page
            _empty(page)
        except BaseException:
            page.context.close()  # whatever it is in the middle of
            raise
        free.append(page)

    def _new(self, kind: Kind) -> Page:
        context = self.browser.new_context(has_touch=kind.touch, is_mobile=kind.mobile)
        context.add_init_script(SLOW_DISPLAY + kind.scripts)
        return context.new_page()


def _empty(page: Page) -> None:
    """Leave the page, and all that it has stored and that was done to its tab."""
    context = page.context
    for other in context.pages:
        if other is not page:
            other.close()
    context.set_offline(False)
    tools = context.new_cdp_session(page)
    let_go(page, tools)
    page.evaluate("() => { try { sessionStorage.clear(); } catch { /* an empty tab has none */ } }")
    origin = page.evaluate("location.origin")
    page.goto("about:blank")
    if origin.startswith("http"):
        what = {"origin": origin, "storageTypes": EMPTIED}
        tools.send("Storage.clearDataForOrigin", what)
    tools.detach()
    context.clear_cookies()


def let_go(page: Page, tools: CDPSession) -> None:
    """Release all that is held: keys, buttons of the mouse, fingers."""
    for key in HELD:
        page.keyboard.up(key)
    page.mouse.up()
    page.mouse.move(0, 0)
    with suppress(Error):  # no finger is down
        tools.send("Input.dispatchTouchEvent", {"type": "touchCancel", "touchPoints": []})


@contextmanager
def no_complaints(page: Page, *, console: bool = True) -> Iterator[list[str]]:
    """Fail for every error of the page's scripts in the block, and for all in the `console`.

    Yield the complaints so far; what is removed is forgiven.
    """
    complaints: list[str] = []

    def hear(message: ConsoleMessage) -> None:
        if console and OF_THE_RENDERER not in message.text:
            complaints.append(message.text)

    def fail(error: Error) -> None:
        complaints.append(str(error))

    page.on("console", hear)
    page.on("pageerror", fail)
    try:
        yield complaints
    finally:
        page.remove_listener("console", hear)
        page.remove_listener("pageerror", fail)
    assert complaints == []
