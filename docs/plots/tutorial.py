"""Does in a browser what the tutorial says before each of its pictures, and takes them.

    python -m tests.book.reader --pictures docs/images/tutorial docs/tutorial/drive.md

The reader of a page comes to a picture, and the row of its name in `SHOTS` is done: so words of
the page that change, or a button that is gone, fail the test of that page.
"""

import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import Final

from PIL import Image
from playwright.sync_api import Browser, Page, expect, sync_playwright

ADDRESS: Final = "http://127.0.0.1:8080"
"""The page of `pioneer3 run`."""
SIZE: Final = (1280, 800)
"""Width and height of a window."""
COLORS: Final = 192
"""Colors of a picture: enough for the page, in a third of the bytes."""
PATIENCE: Final = 60_000.0
"""Longest wait for anything on the page [ms]."""


class Desk:
    """A browser with a window for each person.

    Attributes:
        page: The window that was used last.
    """

    def __init__(self, browser: Browser, folder: Path | None) -> None:
        self._browser = browser
        self._folder = folder
        self._windows: dict[str, Page] = {}
        self.page = self.window("")

    def window(self, person: str) -> Page:
        """Return the window of a person, and use it from now on."""
        if person not in self._windows:
            width, height = SIZE
            context = self._browser.new_context(
                viewport={"width": width, "height": height}, color_scheme="light"
            )
            self._windows[person] = context.new_page()
        self.page = self._windows[person]
        return self.page

    def look(self, path: str) -> None:
        """Do what comes before a picture, and take it where pictures are kept."""
        shot = SHOTS.get(Path(path).name) if "/tutorial/" in path else None
        if shot is None:
            return
        shot(self)
        if self._folder:
            picture = Image.open(BytesIO(self.page.screenshot()))
            picture.quantize(COLORS).save(self._folder / Path(path).name, optimize=True)

    def wait(self, seconds: float) -> None:
        """Let time pass."""
        self.page.wait_for_timeout(1000 * seconds)

    def press(self, words: str) -> None:
        """Press the button of these words."""
        self.page.get_by_role("button", name=words).first.click()

    def hold(self, *keys: str, seconds: float) -> None:
        """Hold keys for so long; the last of them is held still."""
        for key in keys:
            self.page.keyboard.down(key)
            self.wait(seconds)
            if key != keys[-1]:
                self.page.keyboard.up(key)

    def let_go(self, *keys: str) -> None:
        """Let go of keys."""
        for key in keys:
            self.page.keyboard.up(key)

    def sees(self, words: str) -> None:
        """Wait until the page has these words."""
        expect(self.page.get_by_text(words).first).to_be_visible()


def open_page(desk: Desk) -> None:
    """Open the page, and wait for the robot."""
    desk.page.goto(ADDRESS)
    expect(desk.page.locator("#badge")).to_have_text("SIMULATOR")
    desk.wait(2.0)


def hold_the_arrow(desk: Desk) -> None:
    """Drive ahead; the arrow is held when the picture is taken."""
    desk.hold("ArrowUp", seconds=2.0)


def stop(desk: Desk) -> None:
    """Let go, and press the emergency stop."""
    desk.let_go("ArrowUp")
    desk.page.keyboard.press("Space")
    desk.wait(1.0)
    desk.page.keyboard.press("k")
    expect(desk.page.locator("#alarm")).to_be_visible()


def drive_a_circle(desk: Desk) -> None:
    """Release the emergency stop, and drive a bow with two arrows."""
    desk.press("Reset the emergency stop")
    expect(desk.page.locator("#alarm")).to_be_hidden()
    desk.page.keyboard.down("ArrowUp")
    desk.hold("ArrowLeft", seconds=8.0)


def drive_to_the_middle(desk: Desk) -> None:
    """Drive ahead for a moment."""
    open_page(desk)
    desk.hold("ArrowUp", seconds=3.0)
    desk.let_go("ArrowUp")
    desk.wait(2.0)


def look_at_the_glass(desk: Desk) -> None:
    """Wait until the laser is there."""
    open_page(desk)
    desk.wait(4.0)


def wander(desk: Desk) -> None:
    """Let the robot explore, and look at it after a while."""
    open_page(desk)
    desk.press("Modes")
    desk.page.get_by_label("Manner").select_option("explore")
    desk.press("Start wandering")
    desk.page.keyboard.press("Escape")
    desk.wait(20.0)


def follow(desk: Desk) -> None:
    """Let the robot follow somebody."""
    open_page(desk)
    desk.press("Modes")
    desk.press("Start following")
    desk.page.keyboard.press("Escape")
    desk.sees("follows at")
    desk.wait(10.0)


SHOTS: Final[Mapping[str, Callable[[Desk], None]]] = MappingProxyType(
    {
        "drive-first.png": open_page,
        "drive-ahead.png": hold_the_arrow,
        "drive-stopped.png": stop,
        "drive-circle.png": drive_a_circle,
        "sonar-cones.png": drive_to_the_middle,
        "sonar-glass.png": look_at_the_glass,
        "wander-explore.png": wander,
        "wander-follow.png": follow,
    }
)
"""Deeds before each picture, by the name of its file in docs/images/tutorial."""


@contextmanager
def at_a_desk(folder: Path | None) -> Iterator[Desk]:
    """Open a browser; pictures go to a folder, if there is one."""
    names = ("chromium-headless-shell", "chromium", "chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=next(filter(None, map(shutil.which, names)), None),
            args=["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"],
        )
        expect.set_options(timeout=PATIENCE)
        yield Desk(browser, folder)
        browser.close()
