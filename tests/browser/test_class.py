"""A class in real browsers: students join and drive their own robots, the teacher sees to all."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

import pytest
from playwright.sync_api import Page, expect

from pioneer3.log.reader import open_log
from tests.browser.support import hold, until, wait_for_the_robot
from tests.browser.tabs import PHONE, Size, Tabs, no_complaints
from tests.browser.test_accessibility import faults

DESKTOP = (1280, 800)
MOVED = 0.1
"""A robot that is farther from where it was has been driven [m]."""
DRIVES = """
from pioneer3 import connect
with connect({url!r}) as robot:
    print("connected", flush=True)
    for _ in robot.snapshots():
        robot.drive(0.1, 0.5)
"""


@dataclass(frozen=True)
class Class:
    """A class that runs in a process of its own: its address, and where it keeps runs."""

    address: str
    folder: Path

    def get(self, path: str) -> Any:
        """Return the answer of the HTTP API, as the teacher gets it."""
        with urlopen(f"{self.address}/api/class{path}") as answer:
            return json.load(answer)

    def ask(self, method: str, path: str, **body: bool) -> None:
        """Have the HTTP API do something, as the teacher."""
        headers = {"Content-Type": "application/json"}
        data = json.dumps(body).encode() if body else None
        urlopen(Request(f"{self.address}/api{path}", data, headers, method=method)).close()

    def begin_anew(self) -> None:
        """Show all students out, and put the robots back, free to drive."""
        for seat in self.get("")["seats"]:
            if seat["name"] is not None:
                self.ask("DELETE", f"/class/robots/{seat['robot']}")
            self.ask("POST", f"/robots/{seat['robot']}/reset")
        self.ask("PUT", "/class/paused", paused=False)
        self.ask("PUT", "/class/locked", locked=False)
        self.ask("PUT", "/class/shared", shared=True)
        self.ask("POST", "/class/put_back")

    @property
    def link(self) -> str:
        """The link for students."""
        return str(self.get("/link")["url"])

    def url(self, robot: int) -> str:
        """Return where programs reach a robot."""
        return str(self.get("")["seats"][robot - 1]["url"])


@pytest.fixture(scope="module")
def running_class(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Class]:
    """Run a class of two for all tests of this file."""
    home = tmp_path_factory.mktemp("class")
    folder = home / "runs"
    command = [sys.executable, "-m", "pioneer3", "class", "--students", "2"]
    ports = ["--web-port", "0", "--sim-port", "0", "--folder", str(folder)]
    with subprocess.Popen(
        [*command, *ports],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "XDG_STATE_HOME": str(home)},
    ) as process:
        assert process.stdout is not None
        found = None
        for line in process.stdout:
            if found := re.search(r"(http://\S+)/class", line):
                break
        assert found is not None
        yield Class(found[1], folder)
        process.terminate()


@pytest.fixture
def class_(running_class: Class) -> Class:
    """Begin a lesson: nobody has joined, and the robots stand where they began."""
    running_class.begin_anew()
    return running_class


@contextmanager
def looking(tabs: Tabs, url: str, size: Size = DESKTOP) -> Iterator[Page]:
    """Open `url` in a browser of its own; an error of its scripts fails the test."""
    with tabs.open(size=size) as page, no_complaints(page, console=False):
        page.goto(url)
        yield page


@contextmanager
def student(tabs: Tabs, class_: Class, name: str, size: Size = DESKTOP) -> Iterator[Page]:
    """Join under a name, and open the page of the own robot."""
    with looking(tabs, class_.link, size) as page:
        page.fill("#name", name)
        page.click("#join")
        page.wait_for_url("**/")
        wait_for_the_robot(page)
        yield page


@contextmanager
def teacher(tabs: Tabs, class_: Class, size: Size = DESKTOP) -> Iterator[Page]:
    """Open the teacher's page, and wait for all robots."""
    with looking(tabs, f"{class_.address}/class", size) as page:
        until(lambda: all(robot["snapshot"] for robot in state(page)["robots"]) and seats(page))
        yield page


def state(page: Page) -> Any:
    """Return what a page tells tests."""
    return page.evaluate("JSON.parse(JSON.stringify(window.pioneer3?.state ?? {robots: []}))")


def seats(page: Page) -> Any:
    """Return the seats of the class, as the teacher's page has them."""
    return (state(page).get("class") or {}).get("seats", [])


def place(page: Page, robot: int) -> tuple[float, float]:
    """Return where a robot is [m], as the teacher's page has it."""
    pose = state(page)["robots"][robot - 1]["snapshot"]["robot_in_map"]
    return pose["x"], pose["y"]


def has_moved(page: Page, robot: int, start: tuple[float, float]) -> bool:
    """Whether a robot is somewhere else than at `start`."""
    x, y = place(page, robot)
    return hypot(x - start[0], y - start[1]) > MOVED


def tile(page: Page, robot: int) -> Any:
    """Return the part of the teacher's page for a robot."""
    return page.locator(".tile").nth(robot - 1)


def press(page: Page, key: str, done: Callable[[], bool]) -> None:
    """Hold a key until something is true."""
    hold(page, key, done)
    page.keyboard.up(key)


@contextmanager
def program(url: str) -> Iterator[subprocess.Popen[str]]:
    """Let a program drive the robot at `url` while the block lasts."""
    command = [sys.executable, "-c", DRIVES.format(url=url)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=os.environ
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "connected\n"
        try:
            yield process
        finally:
            process.kill()


def test_two_students_join_by_one_link_and_drive_only_their_own(tabs: Tabs, class_: Class) -> None:
    with (
        teacher(tabs, class_) as desk,
        student(tabs, class_, "Ann") as ann,
        student(tabs, class_, "Ben", PHONE) as ben,
    ):
        assert "#" not in ann.evaluate("location.href")
        expect(desk.locator("#joined")).to_have_text("2 of 2 have joined")
        for page, name in ((ann, "Ann"), (ben, "Ben")):
            expect(page.locator("#name")).to_have_text(name)
            assert len(state(page)["robots"]) == 1
            expect(page.locator("#robots")).to_be_hidden()
            expect(page.locator("#edit")).to_be_hidden()
        starts = place(desk, 1), place(desk, 2)
        press(ann, "ArrowUp", lambda: has_moved(desk, 1, starts[0]))
        assert not has_moved(desk, 2, starts[1])
        expect(tile(desk, 1).locator("h2")).to_have_text("Ann")
        refused = ann.evaluate("""async () => (await fetch("/api/robots/2/drive", {
            method: "POST", headers: {"Content-Type": "application/json"}, body: '{"v": 0.2}',
        })).status""")
        assert refused in {403, 404}
        assert not has_moved(desk, 2, starts[1])


def test_a_student_copies_the_line_that_installs_and_loads_a_program(
    tabs: Tabs, class_: Class
) -> None:
    line = class_.get("/installation")["command"].replace("127.0.0.1", "localhost")
    with student(tabs, class_, "Ann") as ann:
        ann.click(".views [data-view=program]")
        copied = ann.locator(f"#own-install [aria-label='Copy: {line}']")
        expect(copied).to_be_visible()
        copied.click()
        expect(ann.locator("#toast")).to_have_text("Copied.")
        with ann.expect_download() as loaded:
            ann.click("#own-install a[download='square.py']")
        assert f'"{class_.url(1)}"' in loaded.value.path().read_text()
    with looking(tabs, class_.link, PHONE) as page:
        expect(page.locator("#install-steps")).to_be_hidden()
        page.click("#install summary")
        expect(page.locator("#install-steps")).to_contain_text(line)
        page.click("#install-steps li:nth-child(2) button")
        expect(page.locator("#copied")).to_have_text("Copied.")


def test_who_joins_again_has_the_same_robot_and_a_full_class_says_so(
    tabs: Tabs, class_: Class
) -> None:
    with (
        student(tabs, class_, "Ann") as ann,
        student(tabs, class_, "Ben"),
        looking(tabs, class_.link) as late,
    ):
        ann.goto("about:blank")
        ann.goto(class_.link)
        ann.wait_for_url("**/")
        wait_for_the_robot(ann)
        expect(ann.locator("#name")).to_have_text("Ann")
        late.fill("#name", "Cid")
        late.click("#join")
        expect(late.locator("#lead")).to_contain_text("full")
        expect(late.locator("#form")).to_be_visible()


def test_a_wrong_link_and_a_locked_class_say_how_to_go_on(tabs: Tabs, class_: Class) -> None:
    with looking(tabs, f"{class_.address}/join#wrong") as page:
        page.fill("#name", "Eve")
        page.click("#join")
        expect(page.locator("#lead")).to_contain_text("Your teacher can show it")
        expect(page.locator("#code")).to_be_focused()
    with teacher(tabs, class_) as desk, looking(tabs, class_.link) as page:
        desk.click("#lock")
        expect(desk.locator("#lock")).to_have_text("Let students join")
        page.fill("#name", "Eve")
        page.keyboard.press("Enter")
        expect(page.locator("#lead")).to_contain_text("obody else can join")
        desk.click("#lock")
        expect(desk.locator("#lock")).to_have_text("Lock joining")
        page.click("#join")
        page.wait_for_url("**/")


def test_the_code_on_the_projector_is_typed_as_people_write_it(tabs: Tabs, class_: Class) -> None:
    with teacher(tabs, class_) as desk:
        desk.click("#invitation-small")
        address = desk.locator("#projector-address").inner_text()
        code = desk.locator("#projector-code").inner_text()
        assert f"{address}#{code.replace(' ', '')}" == class_.link
        with looking(tabs, address) as page:
            page.fill("#code", code.upper())
            page.fill("#name", "Ann")
            page.click("#join")
            page.wait_for_url("**/")
        expect(desk.locator("#projector-names")).to_have_text("Ann")


def test_pause_all_shows_everywhere_and_nobody_drives(tabs: Tabs, class_: Class) -> None:
    with teacher(tabs, class_) as desk, student(tabs, class_, "Ann") as ann:
        desk.keyboard.press("Space")
        expect(ann.locator("#class-news")).to_have_text("The teacher has paused all robots.")
        expect(desk.locator("#pause-all-text")).to_have_text("Go on")
        expect(tile(desk, 1).locator(".marks")).to_contain_text("PAUSED")
        start = place(desk, 1)
        ann.keyboard.down("ArrowUp")
        expect(ann.locator("#toast")).to_contain_text("paused all robots")
        ann.keyboard.up("ArrowUp")
        assert not has_moved(desk, 1, start)
        desk.click("#pause-all")
        expect(ann.locator("#class-news")).to_have_text("")
        press(ann, "ArrowUp", lambda: has_moved(desk, 1, start))
        tile(desk, 1).get_by_role("button", name="Pause Ann").click()
        expect(ann.locator("#class-news")).to_contain_text("The teacher has paused")
        expect(desk.locator("#pause-all-text")).to_have_text("Pause all")
        tile(desk, 1).get_by_role("button", name="Let go on Ann").click()
        expect(ann.locator("#class-news")).to_have_text("")


def test_stop_all_latches_all_robots_and_keeps_them_paused(tabs: Tabs, class_: Class) -> None:
    with teacher(tabs, class_) as desk, student(tabs, class_, "Ann") as ann:
        desk.keyboard.press("k")
        expect(desk.locator("#latched-words")).to_contain_text("EMERGENCY STOP of all robots")
        expect(ann.locator("#alarm")).to_be_visible()
        desk.click("#reset-all")
        expect(desk.locator("#latched")).to_be_hidden()
        expect(ann.locator("#class-news")).to_have_text("The teacher has paused all robots.")
        desk.click("#pause-all")
        expect(ann.locator("#class-news")).to_have_text("")


def test_a_take_over_opens_the_robot_and_the_student_is_told(tabs: Tabs, class_: Class) -> None:
    with teacher(tabs, class_) as desk, student(tabs, class_, "Ann") as ann:
        with desk.expect_popup() as opened:
            tile(desk, 1).get_by_role("button", name="Take over").click()
        page = opened.value
        wait_for_the_robot(page)
        expect(page.locator("#driver")).to_have_text("You have control")
        expect(ann.locator("#class-news")).to_contain_text("eacher drives your robot")
        start = place(desk, 1)
        press(page, "ArrowUp", lambda: has_moved(desk, 1, start))
        page.reload()  # takes over no second time
        wait_for_the_robot(page)
        expect(ann.locator("#class-news")).to_have_text("")
        expect(page.locator("#driver")).not_to_have_text("You have control")
        page.close()
        start = place(desk, 1)
        press(ann, "ArrowUp", lambda: has_moved(desk, 1, start))


def test_an_own_program_drives_while_the_page_shows_it(tabs: Tabs, class_: Class) -> None:
    with teacher(tabs, class_) as desk, student(tabs, class_, "Ann") as ann:
        ann.click(".views [data-view=program]")
        url = class_.url(1)
        expect(ann.locator("#own-url")).to_have_text(url)
        expect(ann.locator("#own-program")).to_have_text("No program is connected.")
        assert len(ann.locator("#own-example").inner_text().splitlines()) == 4
        start = place(desk, 1)
        with program(url):
            expect(ann.locator("#class-news")).to_contain_text("Your program drives your robot")
            expect(tile(desk, 1).locator(".who-drives")).to_have_text("program drives")
            until(lambda: has_moved(desk, 1, start))
            ann.keyboard.down("ArrowUp")
            expect(ann.locator("#toast")).to_contain_text("Your program drives your robot")
            ann.keyboard.up("ArrowUp")
        expect(ann.locator("#class-news")).to_have_text("")
        start = place(desk, 1)
        press(ann, "ArrowDown", lambda: has_moved(desk, 1, start))


def test_the_example_of_the_page_runs(tabs: Tabs, class_: Class) -> None:
    with student(tabs, class_, "Ann") as ann:
        ann.click(".views [data-view=program]")
        code = ann.locator("#own-example").inner_text()
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_run_is_recorded_handed_in_downloaded_and_replayed(tabs: Tabs, class_: Class) -> None:
    with teacher(tabs, class_) as desk, student(tabs, class_, "Ann", PHONE) as ann:
        ann.click("#details")  # on a student's phone it opens the part about programs first
        ann.click("#recording-begin")
        expect(ann.locator("#recording")).to_contain_text("Recording")
        expect(tile(desk, 1).locator(".marks")).to_contain_text("REC")
        ann.click("#recording-end")
        expect(ann.locator("#recording-state")).to_contain_text("not handed in")
        ann.click("#recording-hand_in")
        expect(ann.locator("#own-runs")).to_contain_text("Handed in: Ann")
        expect(desk.locator("#runs-count")).to_have_text("1")
        desk.click("#runs-open")
        with desk.expect_download() as download:
            desk.locator("#runs-list a[download]").click()
        counts = open_log(download.value.path()).info().counts
        assert download.value.suggested_filename in {path.name for path in class_.folder.iterdir()}
        assert counts is not None
        assert counts["wire/robot/in"] > 0
        with desk.expect_popup() as beside:
            desk.get_by_role("link", name="Replay Ann-1.mcap").click()
        expect(beside.value.locator("body.replaying")).to_be_visible()


def test_put_back_asks_first_and_moves_the_robot_to_its_start(tabs: Tabs, class_: Class) -> None:
    with teacher(tabs, class_) as desk, student(tabs, class_, "Ann") as ann:
        start = place(desk, 1)
        press(ann, "ArrowUp", lambda: has_moved(desk, 1, start))
        button = tile(desk, 1).get_by_role("button", name="Put back")
        button.click()
        desk.keyboard.press("Enter")  # on the button that changes nothing
        expect(desk.locator("#question")).to_be_hidden()
        button.click()
        expect(desk.locator("#question-title")).to_have_text("Put Ann back?")
        desk.keyboard.press("Escape")
        expect(desk.locator("#question")).to_be_hidden()
        assert has_moved(desk, 1, start)
        desk.click("#put-all-back")
        desk.click("#question-yes")
        until(lambda: not has_moved(desk, 1, start))


def test_a_student_who_is_shown_out_or_leaves_is_told_how_to_join(
    tabs: Tabs, class_: Class
) -> None:
    with (
        teacher(tabs, class_) as desk,
        student(tabs, class_, "Ann") as ann,
        student(tabs, class_, "Ben") as ben,
    ):
        tile(desk, 1).get_by_role("button", name="Free the seat of Ann").click()
        desk.click("#question-yes")
        ann.wait_for_url("**/join")
        expect(ann.locator("#code")).to_be_visible()
        expect(tile(desk, 1).locator("h2")).to_have_text("free")
        ben.click(".views [data-view=program]")
        ben.click("#leave-class")
        ben.click("#leave-yes")
        ben.wait_for_url("**/join")
        expect(desk.locator("#joined")).to_have_text("0 of 2 have joined")


@pytest.mark.parametrize(
    ("size", "scheme"), [(DESKTOP, "light"), (PHONE, "dark")], ids=["desktop-light", "phone-dark"]
)
def test_axe_finds_no_grave_fault_on_the_pages_of_a_class(
    tabs: Tabs, class_: Class, size: Size, scheme: Any
) -> None:
    with tabs.open(class_.link, size=size, scheme=scheme) as page:
        expect(page.locator("#form")).to_be_visible()
        assert_no_grave_fault(page, class_)
    with student(tabs, class_, "Ann", size) as ann:
        ann.click(".views [data-view=program]" if size == DESKTOP else "#details")
        expect(ann.locator("#own-url")).to_be_visible()
        expect(ann.locator("#class-news")).to_be_visible()
        assert faults(ann) == []


def assert_no_grave_fault(page: Page, class_: Class) -> None:
    """Look at the page for joining, the lessons, and the teacher's page with its dialogs."""
    assert faults(page) == []
    page.goto(f"{class_.address}/lessons")
    assert faults(page) == []
    page.goto(f"{class_.address}/class")
    until(lambda: bool(seats(page)))
    assert faults(page) == []
    for opener, dialog, closer in (
        ("#invitation-small", "#projector", "#projector-close"),
        ("#runs-open", "#runs", "#runs-close"),
        ("#put-all-back", "#question", "#question-no"),
    ):
        page.click(opener)
        expect(page.locator(dialog)).to_be_visible()
        assert faults(page) == [], dialog
        page.click(closer)
    page.click("#pause-all")
    expect(page.locator("#paused")).not_to_be_empty()
    assert faults(page) == []


@pytest.mark.parametrize("width", [320, 390, 1280, 1920, 3840])
def test_the_teachers_page_fits_every_screen(tabs: Tabs, class_: Class, width: int) -> None:
    size = (width, 568 if width < 500 else width * 9 // 16)
    with teacher(tabs, class_, size) as desk:
        wide, room = desk.evaluate(
            "[document.documentElement.scrollWidth, document.documentElement.clientWidth]"
        )
        assert wide <= room
        for name in ("#pause-all", "#stop-all"):
            desk.evaluate("scrollTo(0, document.documentElement.scrollHeight)")
            box = desk.locator(name).bounding_box()
            assert box is not None
            assert 0 <= box["y"] <= size[1] - box["height"]  # in sight wherever one scrolls


def test_the_keyboard_reaches_all_buttons_of_a_robot(tabs: Tabs, class_: Class) -> None:
    with teacher(tabs, class_) as desk, student(tabs, class_, "Ann"):
        expect(tile(desk, 1).locator("h2")).to_have_text("Ann")
        tile(desk, 1).locator(".open").focus()
        labels = []
        for _ in range(4):
            desk.keyboard.press("Tab")
            labels.append(desk.evaluate("document.activeElement.getAttribute('aria-label')"))
        assert [label.partition(" ")[0] for label in labels] == ["Take", "Pause", "Put", "Free"]
        assert all("Ann" in label for label in labels)


def test_the_teachers_page_shows_robots_that_stand_also_when_it_is_opened_again(
    tabs: Tabs, class_: Class
) -> None:
    for _ in range(2):
        with teacher(tabs, class_) as desk:
            for robot in (1, 2):
                expect(tile(desk, robot).locator(".who-drives")).to_have_text("nobody drives")


def test_pictures_are_drawn_only_while_robots_move(tabs: Tabs, class_: Class) -> None:
    with teacher(tabs, class_) as desk, student(tabs, class_, "Ann") as ann:
        start = place(desk, 1)
        before = state(desk)["pictures"]
        press(ann, "ArrowUp", lambda: has_moved(desk, 1, start))
        assert state(desk)["pictures"] > before
