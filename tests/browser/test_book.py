"""The book as it is built: whole, light, and served without asking another host."""

import re
import shutil
import subprocess
import sys
import zlib
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from threading import Thread
from urllib.parse import parse_qs, unquote, urldefrag, urlsplit

import pytest
import uvicorn
from cyclopts import App
from playwright.sync_api import Page, Request, expect
from starlette.applications import Starlette

import pioneer3
from docs.reference.made import commands, exceptions, exit_codes, make, operations
from pioneer3.behaviors.modes import MODES
from pioneer3.behaviors.modes.group import GROUP_MODES
from pioneer3.cli.main import Exit, app
from pioneer3.errors import ConfigError
from pioneer3.nav.settings import SETTINGS
from pioneer3.ros.node.driving_parameters import PARAMETERS as DRIVING
from pioneer3.ros.node.laser_parameters import LaserParameters
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.navigation_topics import NAVIGATION_TOPICS
from pioneer3.ros.node.parameter import rows_of
from pioneer3.ros.node.parameters import parameters_in
from pioneer3.ros.node.services import NAVIGATION_SERVICES, SERVICES
from pioneer3.ros.node.topics import TOPICS
from pioneer3.web.api.routes import OPERATIONS
from pioneer3.web.book import book_routes, find_page
from tests.browser.support import until
from tests.browser.tabs import Tabs, no_complaints

ROOT = Path(__file__).parents[2]
LARGEST = 15e6
"""Size of the book with all its pictures [bytes]."""
PACKAGES = (
    *("pioneer3.behaviors", "pioneer3.behaviors.actions", "pioneer3.behaviors.modes"),
    *("pioneer3.gym", "pioneer3.log", "pioneer3.maps", "pioneer3.models"),
    *("pioneer3.robot.devices", "pioneer3.sim.worldfile"),
)
"""Packages that programs import from; the protocol's commands and reports have tables."""
ERRORS = {f"pioneer3.{name}" for name in pioneer3.__all__ if name.endswith("Error")}
"""Exceptions; they have a table."""
SAMPLE = ("", "reference/python-api/", "how-to/laser/", "tutorial/drive/", "reference/protocol/")
"""Pages with all that any page has: pictures, tables, code, names of the API."""


@pytest.fixture(scope="module")
def book(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the book as `scripts/docs` does, in a folder of its own."""
    folder = tmp_path_factory.mktemp("book")
    for name in ("src", "examples"):
        (folder / name).symlink_to(ROOT / name)
    shutil.copytree(ROOT / "docs", folder / "docs")
    make(folder / "docs/made")
    config = (ROOT / "zensical.toml").read_text()
    (folder / "zensical.toml").write_text(config.replace("src/pioneer3/book", "site"))
    zensical = Path(sys.executable).with_name("zensical")
    done = subprocess.run(
        [zensical, "build", "--clean", "--strict"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "site"


@contextmanager
def served(book: Path) -> Iterator[str]:
    """Serve the book as the page's server does; yield its address."""
    app = Starlette(routes=book_routes(book))
    config = uvicorn.Config(app, port=0, log_config=None, access_log=False, lifespan="off")
    server = uvicorn.Server(config)
    thread = Thread(target=server.run)
    thread.start()
    until(lambda: server.started)
    try:
        yield f"http://127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}/book/"
    finally:
        server.should_exit = True
        thread.join()


class Links(HTMLParser):
    """Collects what a page names: other files, and its own anchors."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.named: list[str] = []
        self.anchors: set[str] = set()
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take a tag."""
        for key, value in attrs:
            if key == "id" and value:
                self.anchors.add(value)
            elif key in {"href", "src"} and value:
                self.named.append(value)


def test_every_link_and_anchor_of_the_book_leads_somewhere(book: Path) -> None:
    pages = {path: Links(path.read_text()) for path in book.rglob("*.html")}
    dead = defaultdict(set)
    for path, links in pages.items():
        if path.name == "404.html":  # served for any path, it names its parts from the root
            continue
        for link in links.named:
            url, anchor = urldefrag(link)
            if urlsplit(url).scheme or url.startswith("//"):
                continue
            target = (path.parent / unquote(url)).resolve() if url else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists() or (
                anchor and target in pages and unquote(anchor) not in pages[target].anchors
            ):
                dead[path.relative_to(book).as_posix()].add(link)
    assert dead == {}
    assert len(pages) > 50


def test_every_page_has_its_line_in_the_order() -> None:
    config = (ROOT / "zensical.toml").read_text()
    pages = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")}
    left_out = {page for page in pages if page.startswith("made/")} | {"package.md"}
    assert pages - set(re.findall(r'"([\w/-]+\.md)"', config)) == left_out


def test_every_example_is_on_its_page() -> None:
    page = (ROOT / "docs/how-to/examples.md").read_text()
    examples = (path.relative_to(ROOT).as_posix() for path in (ROOT / "examples").rglob("*.py"))
    assert [path for path in examples if f'--8<-- "{path}"' not in page] == []


def test_every_public_name_has_its_place_in_the_reference(book: Path) -> None:
    inventory = (book / "objects.inv").read_bytes().split(b"zlib.\n", 1)[1]
    listed = {line.split()[0] for line in zlib.decompress(inventory).decode().splitlines()}
    missing = [
        f"{package}.{name}"
        for package in ("pioneer3", *PACKAGES)
        for name in import_module(package).__all__
        if f"{package}.{name}" not in PACKAGES
        if not {f"{package}.{name}", f"{package}.{name}.{name}"} & (listed | ERRORS)
    ]
    assert missing == []
    assert "pioneer3.BlockingRobot.move" in listed  # made blocking from `Robot.move`


def test_every_command_and_option_is_in_the_reference() -> None:
    text = commands()
    missing: list[tuple[str, str]] = []
    for path, command in commands_of(app):
        section = text.partition(f"## pioneer3 {path}\n")[2].partition("\n## pioneer3 ")[0]
        arguments = command.assemble_argument_collection()
        for one in arguments:
            option = one.names[0]
            if one.show and option not in section and option[2:].upper() not in section:
                missing.append((path, option))
    assert missing == []
    assert " -m tests" not in text
    assert " -m pytest" not in text


def commands_of(parent: App, path: str = "") -> Iterator[tuple[str, App]]:
    """Return the commands below `parent` by their words."""
    for name in parent:
        if not name.startswith("-"):
            command, words = parent[name], f"{path} {name}".strip()
            if command.default_command is not None:
                yield words, command
            yield from commands_of(command, words)


def test_every_topic_parameter_setting_and_operation_is_in_the_book() -> None:
    text = "".join(page.read_text() for page in (ROOT / "docs").rglob("*.md")) + operations()
    topics = {name for each in (*TOPICS, *NAVIGATION_TOPICS) for name in each.names(Profile.ROS2)}
    services = {
        name for each in (*SERVICES, *NAVIGATION_SERVICES) for name in each.names(Profile.ROS2)
    }
    parameters = {row.name for each in Profile for row in parameters_in(each)}
    parameters |= {row.name for row in (*DRIVING, *rows_of(LaserParameters))}
    modes = {one.name for mode in (*MODES, *GROUP_MODES) for one in mode.parameters()}
    names = topics | services | parameters | modes | set(SETTINGS)
    assert [
        name for name in sorted(names) if f"`{name}`" not in text and f"`~{name}`" not in text
    ] == []
    assert [one for one in OPERATIONS if f"`{one.method} {one.path}`" not in text] == []


def test_every_error_and_exit_code_is_in_the_reference() -> None:
    text = exceptions()
    assert [name for name in ERRORS if f"`{name.rpartition('.')[2]}`" not in text] == []
    assert len(exit_codes().splitlines()) == 2 + len(Exit)


def test_the_book_is_light(book: Path) -> None:
    assert sum(path.stat().st_size for path in book.rglob("*") if path.is_file()) < LARGEST


def test_a_page_is_found_by_its_name_with_a_hint_at_those_near(book: Path) -> None:
    assert find_page("", book) == ""
    assert find_page("laser", book) == find_page("how-to/laser.md", book) == "how-to/laser/"
    assert find_page("how-to/drive#keys", book) == "how-to/drive/#keys"
    with pytest.raises(ConfigError, match=r"no page 'lasr'; there is .*how-to/laser"):
        find_page("lasr", book)
    with pytest.raises(ConfigError, match=r"several pages .* how-to/"):
        find_page("drive", book)


def test_without_a_book_it_is_said_how_to_make_one(tmp_path: Path) -> None:
    assert book_routes(tmp_path) == []
    with pytest.raises(ConfigError, match="scripts/docs"):
        find_page("", tmp_path)


def test_no_page_asks_another_host(book: Path, tabs: Tabs) -> None:
    with served(book) as address, tabs.open() as page, no_complaints(page):
        asked: list[str] = []
        page.on("request", lambda request: note(request, asked))
        for name in SAMPLE:
            page.goto(address + name, wait_until="networkidle")
        assert len(asked) > len(SAMPLE)
        assert [url for url in asked if not url.startswith((address, "blob:", "data:"))] == []


def note(request: Request, asked: list[str]) -> None:
    """Note the address of a request."""
    asked.append(request.url)


def test_the_search_finds_a_page(book: Path, tabs: Tabs) -> None:
    with served(book) as address, tabs.open(address) as page, no_complaints(page):
        search(page, "bumper")
        expect(page.get_by_text(re.compile(r"\d+ results"))).to_be_visible()


QUESTIONS = {
    "serial TCP": "how-to/onboard-computer/",
    "does not move": "troubleshooting/does-not-move/",
    "max speed": "how-to/speed-limits/",
    "save data csv": "how-to/csv/",
    "replay a log": "how-to/look-back/",
    "why did it stop twenty minutes ago?": "how-to/look-back/",
    "start at boot": "how-to/onboard-computer/",
    "notebook": "how-to/notebook/",
    "calibrate odometry": "how-to/calibrate/",
    "own laser": "how-to/laser/",
    "ten robots obstacles": "how-to/obstacles/",
    "nav2": "how-to/nav2/",
    "rostopic echo shows nothing": "troubleshooting/ros-topic-silent/",
    "permission denied": "troubleshooting/no-port/",
    "drives in circles": "troubleshooting/drives-in-circles/",
    "not sure where it is": "troubleshooting/not-sure-where-it-is/",
    "robot won't move": "troubleshooting/does-not-move/",
    "robot stands still": "troubleshooting/does-not-move/",
    "lost connection": "troubleshooting/loses-the-link/",
    "robot drives crooked": "troubleshooting/drives-in-circles/",
    "turn on robot start program automatically": "how-to/onboard-computer/",
    "autostart": "how-to/onboard-computer/",
    "mount laser": "how-to/laser/",
    "hokuyo": "how-to/laser/",
    "laser": "how-to/laser/",
    "camera": "how-to/camera/",
    "see robot jupyter": "how-to/notebook/",
    "turns too little": "how-to/calibrate/",
    "10 robots": "how-to/fleet/",
    "max speed students": "how-to/speed-limits/",
    "csv sonar": "how-to/csv/",
    "how do I use Nav2?": "how-to/nav2/",
    "connect my laser": "how-to/laser/",
    "autostart my own script": "how-to/onboard-computer/",
    "odometry is wrong": "how-to/calibrate/",
    "simulation with obstacles": "how-to/obstacles/",
    "why does my robot not move?": "troubleshooting/does-not-move/",
    "share the serial port over the network": "how-to/onboard-computer/",
}
"""Questions of people, and the page with the answer."""
FIRST = 4
"""Results that a reader looks at."""


def test_the_search_answers_what_people_ask(book: Path, tabs: Tabs) -> None:
    with served(book) as address, tabs.open(address) as page, no_complaints(page):
        search(page, "")
        field = page.get_by_placeholder("Search")
        for words, answer in QUESTIONS.items():
            field.fill(words)
            until(partial(leads, page, words, answer))


def leads(page: Page, words: str, answer: str) -> bool:
    """Return whether one of the first results for `words` is the page `answer`."""
    links = page.locator("a[href*='?h=']")
    found: list[str] = links.evaluate_all("all => all.map(each => each.getAttribute('href'))")
    asked = [urlsplit(each) for each in found if parse_qs(urlsplit(each).query)["h"] == [words]]
    return any(each.path.endswith(f"/{answer}") for each in asked[:FIRST])


def search(page: Page, words: str) -> None:
    """Search for `words` as a reader does."""
    page.wait_for_load_state("networkidle")
    page.keyboard.press("/")
    expect(page.get_by_placeholder("Search")).to_be_focused()
    page.keyboard.type(words)
