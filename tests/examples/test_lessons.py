"""The programs of the lessons do what the teacher's guide says of them, all at the same time."""

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from pioneer3.classroom.downloads import HERE, lesson_programs

LESSONS = Path(__file__).parents[2] / "src/pioneer3/classroom/lessons"
WORLD = """
[world]
name = "wall"
seed = 3

[[wall]]
points = [[1.0, -9.0], [1.0, 9.0]]

[[robot]]
model = "p3dx"
start = { x = 0.0, y = 0.0, theta_deg = 0 }

[[robot]]
model = "p3dx"
start = { x = -6.0, y = 0.0, theta_deg = 0 }

[[robot]]
model = "p3dx"
start = { x = 0.2, y = 5.0, theta_deg = 0 }
"""
PATIENCE = 180.0
"""How long all of it may take on a busy machine [s]."""


@contextmanager
def simulated(*arguments: str) -> Iterator[list[str]]:
    """Run a simulator; yield the address of each robot."""
    command = [sys.executable, "-m", "pioneer3", "sim", "-p", "0", *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        urls: list[str] = []
        while len(urls) < (3 if arguments else 1):
            urls += re.findall(r"tcp://\S+", process.stdout.readline())[-1:]
        try:
            yield urls
        finally:
            process.terminate()


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Run all programs side by side; return what each has printed."""
    world = tmp_path_factory.mktemp("world") / "wall.toml"
    world.write_text(WORLD)
    with simulated("-m", str(world)) as urls, simulated() as office:
        commands = {
            "echoes": [urls[0]],
            "square": [urls[1], "0.4"],
            "keep_clear": [urls[2], "8"],
            "patrol": [office[0], "office", "Home", "Lab"],
        }
        running = {
            name: subprocess.Popen(
                [sys.executable, str(LESSONS / f"{name}.py"), *arguments],
                stdout=subprocess.PIPE,
                text=True,
            )
            for name, arguments in commands.items()
        }
        said = {name: process.communicate(timeout=PATIENCE)[0] for name, process in running.items()}
        assert {name: process.returncode for name, process in running.items()} == dict.fromkeys(
            running, 0
        )
    return said


def test_the_square_ends_where_the_wheels_say(said: dict[str, str]) -> None:
    assert said["square"].count("corner ") == 4
    found = re.search(r"The wheels say: (\d\.\d\d) m from the start", said["square"])
    assert found is not None
    assert float(found[1]) < 0.1


def test_a_wall_answers_up_to_some_angle_and_not_beyond(said: dict[str, str]) -> None:
    rows = re.findall(r"(\d+) deg from the wall's normal: (no echo|\d\.\d\d)", said["echoes"])
    heard = {int(angle): echo for angle, echo in rows}
    assert list(heard) == list(range(10, 80, 5))
    for angle in (10, 20, 30):
        assert 0.7 < float(heard[angle]) < 1.0
    assert {heard[angle] for angle in (60, 65, 70, 75)} == {"no echo"}


def test_the_own_wander_program_turns_away_from_the_wall(said: dict[str, str]) -> None:
    assert "I turn away" in said["keep_clear"]
    assert "stalled" not in said["keep_clear"]


def test_the_patrol_arrives(said: dict[str, str]) -> None:
    assert re.search(r"Lab: there after \d+ s", said["patrol"])


@pytest.mark.realtime
@pytest.mark.timeout(300)
async def test_the_notebook_of_a_class_shows_and_drives_its_robot() -> None:
    with simulated() as (url,):
        book = nbformat.reads(lesson_programs()["notebook.ipynb"].read_text("utf-8"), as_version=4)
        assert all(not cell.get("outputs") for cell in book.cells)
        for cell in book.cells:
            cell.source = cell.source.replace(HERE, url)
        await NotebookClient(book, timeout=200, kernel_name="python3").async_execute()
    outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
    pages = [output["data"].get("text/html", "") for output in outputs]
    assert sum('class="robot"' in page for page in pages) == 2  # the robot, and its live view


def test_the_programs_are_short() -> None:
    for path in LESSONS.glob("*.py"):
        assert len(path.read_text().splitlines()) <= 40, path
