"""Does in a browser what the tutorial says before each of its pictures, and takes them.

    python -m tests.book.reader --pictures docs/images/tutorial docs/tutorial/drive.md

The reader of a page comes to a picture, and the row of its name in `SHOTS` is done: so words of
the page that change, or a button that is gone, fail the test of that page.
"""

import shutil
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from io import BytesIO
from math import atan2, cos, hypot, pi, remainder, sin
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from PIL import Image
from playwright.sync_api import Browser, Page, expect, sync_playwright

ADDRESS: Final = "http://127.0.0.1:8080"
"""The page of `pioneer3 run`."""
SIZE: Final = (1280, 800)
"""Width and height of a window."""
LONGEST: Final = 240.0
"""Longest wait for what the robot does [s]."""
KITCHEN: Final = (6.2, 2.0)
"""Middle of the kitchen of that page's flat [m]."""
BACK: Final = (2.4, 3.0)
"""Place in its first room, on the way from the door [m]."""
DOOR: Final = (4.5, 3.1)
"""The door of that flat [m]."""
KNOB: Final = 46
"""From a place on the map to the knob that turns its heading [px]."""
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

    def choose_kitchen(self) -> None:
        """Open the list of places, and choose the kitchen."""
        self.press("Send")
        self.page.get_by_label("A place of the map").select_option("Kitchen")
        self.wait(3.0)

    def drag(self, begin: tuple[float, float], end: tuple[float, float]) -> None:
        """Drag with the mouse from a point of the window to another one [px]."""
        self.page.mouse.move(*begin)
        self.page.mouse.down()
        self.page.mouse.move(*end, steps=10)
        self.page.mouse.up()

    def state(self, name: str) -> Any:
        """Return a part of the page's state, as its code names it."""
        return self.page.evaluate(f"window.pioneer3.state.{name}")

    def until(self, condition: str) -> None:
        """Wait until a condition about the page's state holds."""
        end = time.monotonic() + LONGEST
        while not self.state(condition):
            assert time.monotonic() < end, condition
            self.wait(0.1)

    def drive_to(self, x: float, y: float) -> None:
        """Drive to a place by the arrow keys, as somebody does who looks at the map [m]."""
        end = time.monotonic() + LONGEST
        while time.monotonic() < end:
            pose = self.state("snapshot.robot_in_map")
            dx, dy = x - pose["x"], y - pose["y"]
            if hypot(dx, dy) < 0.3:
                return
            aside = remainder(atan2(dy, dx) - pose["theta"], 2 * pi)
            key = "ArrowUp" if abs(aside) < 0.3 else "ArrowLeft" if aside > 0 else "ArrowRight"
            self.hold(key, seconds=0.3 if key == "ArrowUp" else min(0.6, abs(aside)))
            self.let_go(key)
        raise AssertionError(f"not at {x}, {y}")

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Return where a place of the map is in the window [m, px]."""
        box = self.page.locator("#canvas").bounding_box()
        assert box
        seen = self.page.evaluate("([x, y]) => window.pioneer3.toScreen(x, y)", [x, y])
        return box["x"] + seen["x"], box["y"] + seen["y"]

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


def explore(desk: Desk) -> None:
    """Begin a map, and let the robot explore for a while."""
    open_page(desk)
    desk.press("Modes")
    desk.press("Begin a map")
    desk.press("Explore")
    desk.until("snapshot.mode !== null")
    desk.wait(25.0)


def name_the_kitchen(desk: Desk) -> None:
    """Wait for the end, drive to the kitchen, and name it."""
    desk.until("snapshot.mode === null")
    desk.drive_to(*DOOR)
    desk.drive_to(*KITCHEN)
    desk.page.get_by_label("This place is").fill("Kitchen")
    desk.press("Name this place")
    desk.wait(3.0)


def plan_to_the_kitchen(desk: Desk) -> None:
    """Save the map, drive back, and propose the kitchen."""
    desk.page.get_by_label("Name of the map").fill("flat")
    desk.press("Finish and save")
    desk.sees("Saved flat.map")
    desk.page.keyboard.press("Escape")
    desk.drive_to(*DOOR)
    desk.drive_to(*BACK)
    desk.choose_kitchen()


def go_to_the_kitchen(desk: Desk) -> None:
    """Let it go, and wait until it is there."""
    desk.page.locator("#goto-go").click()
    desk.until("snapshot.mode !== null")
    desk.until("snapshot.mode === null")
    desk.wait(1.0)


def be_lost(desk: Desk) -> None:
    """Carry the robot from the kitchen to another room, and see that it is not sure."""
    open_page(desk)
    desk.choose_kitchen()
    go_to_the_kitchen(desk)
    pose = desk.state("snapshot.robot_in_map")
    desk.page.keyboard.press("e")
    desk.drag(desk.at(pose["x"], pose["y"]), desk.at(*BACK))
    desk.page.keyboard.press("e")
    expect(desk.page.locator("#unsure")).to_be_visible()
    desk.wait(8.0)  # until the words about the walls on its way are gone


def tell_the_place(desk: Desk) -> None:
    """Click where the robot is, turn the knob to its heading, and tell it."""
    pose = desk.state("snapshot.robot_in_map")
    left, top = desk.at(*BACK)
    desk.page.mouse.click(left, top)
    desk.wait(1.0)
    arm = 2 * KNOB
    aim = left + arm * cos(pose["theta"]), top - arm * sin(pose["theta"])
    desk.drag((left + KNOB, top), aim)
    desk.press("It is here")
    expect(desk.page.locator("#unsure")).to_be_hidden()
    desk.wait(2.0)


def show_the_link(desk: Desk) -> None:
    """Open the teacher's page, and show the link large."""
    desk.page.goto(f"{ADDRESS}/class")
    desk.page.locator("#invitation-small").click()
    desk.wait(1.0)


def join(desk: Desk) -> None:
    """Close the link, join as a student, and drive."""
    link = desk.state("class.join_url")
    desk.page.locator("#projector-close").click()
    desk.window("student").goto(link)
    desk.page.get_by_label("name").first.fill("Anna")
    desk.page.locator("#join").click()
    desk.page.wait_for_url("**/")
    expect(desk.page.locator("#badge")).to_have_text("SIMULATOR")
    desk.wait(1.0)
    desk.hold("ArrowUp", seconds=1.5)


def see_who_drives(desk: Desk) -> None:
    """Look at the teacher's page while the student turns."""
    desk.let_go("ArrowUp")
    desk.hold("ArrowLeft", seconds=1.0)
    desk.window("").wait_for_timeout(1000)


SHOTS: Final[Mapping[str, Callable[[Desk], None]]] = MappingProxyType(
    {
        "drive-first.png": open_page,
        "drive-ahead.png": hold_the_arrow,
        "drive-stopped.png": stop,
        "drive-circle.png": drive_a_circle,
        "sonar-cones.png": drive_to_the_middle,
        "sonar-glass.png": look_at_the_glass,
        "kitchen-explore.png": explore,
        "kitchen-named.png": name_the_kitchen,
        "kitchen-way.png": plan_to_the_kitchen,
        "kitchen-arrived.png": go_to_the_kitchen,
        "kitchen-lost.png": be_lost,
        "kitchen-told.png": tell_the_place,
        "class-link.png": show_the_link,
        "class-student.png": join,
        "class-teacher.png": see_who_drives,
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
