"""The tutorial of fleets, from an empty machine to driving all five robots, as it is written.

Each line is run in the order of the document, on computers of their own with a real sshd, a real
systemd and a real journal; the robots are simulated, behind serial ports.
"""

import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import pytest

from tests.fleet import document
from tests.fleet.lab import PASSWORD, PATIENCE, ROOT, Lab
from tests.fleet.manager import managed, why_no_manager
from tests.fleet.robots import Robots, plugged_in
from tests.fleet.terminal import converse, terminal
from tests.ros1.master import has_ros

pytestmark = [pytest.mark.realtime, pytest.mark.timeout(600)]
TUTORIAL: Final = ROOT / "docs/tutorial/five-robots.md"
DEPLOYING: Final = 300.0
"""Longest time to install on five computers of one machine [s]."""


@dataclass
class Course:
    """A person who follows the tutorial.

    Attributes:
        lab: The computers.
        robots: At their serial ports.
        log: All commands, and all that they have said.
    """

    lab: Lab
    robots: Robots
    log: list[str] = field(default_factory=list)

    @property
    def folder(self) -> Path:
        """Where the commands are typed."""
        return self.lab.operator.home / "lab"

    def run(self, line: str, patience: float = PATIENCE) -> str:
        """Run a line of the shell; return all that it says."""
        began = time.monotonic()
        done = subprocess.run(
            self.lab.operator.in_lab("bash", "-c", line),
            env=self.lab.operator.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=patience,
            check=False,
        )
        self.log.append(f"$ {line}   # {time.monotonic() - began:.1f} s\n{done.stdout}")
        assert done.returncode == 0, done.stdout
        return done.stdout

    def follow(self, title: str, patience: float = PATIENCE) -> dict[str, str]:
        """Run all lines of a section; return what each says."""
        said: dict[str, str] = {}
        for block in document.blocks(document.section(TUTORIAL, title)):
            if block.kind == "sh" and document.SECOND_TERMINAL not in block.before:
                said |= {line: self.run(line, patience) for line in block.lines}
            elif block.kind == "toml":
                self.edit(self.folder / "fleet.toml", block.text)
            elif block.kind == "console":
                command, *lines = block.lines
                with terminal(self.lab.operator, command.removeprefix("$ ")) as the:
                    converse(the, lines, PASSWORD)
                    self.log.append(the.text)
                    assert the.code() == 0, the.text
                    said[command] = the.text
        return said

    @staticmethod
    def edit(path: Path, tables: str) -> None:
        """Add the last line of each table to the table of a file that begins with the others."""
        text = path.read_text()
        for table in tables.strip().split("\n\n"):
            old, _, _ = table.rpartition("\n")
            assert text.count(f"{old}\n") == 1, old
            text = text.replace(old, table)
        path.write_text(text)

    @contextmanager
    def second_terminal(self, title: str, ready: str) -> Iterator[None]:
        """Run the line that a section starts in a second terminal, which says that it is ready."""
        (line,) = (
            block.text.strip()
            for block in document.blocks(document.section(TUTORIAL, title))
            if document.SECOND_TERMINAL in block.before
        )
        with terminal(self.lab.operator, line) as the:
            the.sees(ready)
            yield
            the.press("Ctrl-C")
            the.code()

    def until(self, holds: Callable[[], object]) -> None:
        """Wait until something holds."""
        end = time.monotonic() + PATIENCE
        while not holds():
            assert time.monotonic() < end
            time.sleep(0.1)

    def moving(self) -> list[str]:
        """Return the names of the robots that move, in truth."""
        return [name for name in self.robots.names if not self.robots.now(name).stands]


@pytest.fixture
def course(possible: None, tmp_path: Path) -> Iterator[Course]:
    """Five robots, and an operator with nothing in his home."""
    if reason := why_no_manager():
        pytest.skip(reason)
    if not has_ros():
        pytest.skip("ROS 1 is not installed; scripts/test installs it")
    with Lab(tmp_path, 5, introduced=False) as lab:
        for robot in lab.robots:
            robot.sh("mount -o remount,size=4g /home")
        with plugged_in(lab.robots, tmp_path) as robots, managed(lab.robots):
            course = Course(lab, robots)
            prepare(course)
            yield course
            sys.stdout.write("\n".join(course.log))


def prepare(course: Course) -> None:
    """Let the operator have pioneer3, and nothing else in his home than an empty folder."""
    operator = course.lab.operator
    operator.install("pioneer3", f'exec {sys.executable} -m pioneer3 "$@"')
    operator.install("sudo", 'exec "$@"')  # it is root already
    for path in operator.home.iterdir():
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    course.folder.mkdir()


@pytest.mark.thorough
def test_the_tutorial_leads_from_nothing_to_driving_all_five(course: Course) -> None:
    names = [robot.name for robot in course.lab.robots]
    course.follow("1. Write down")
    course.follow("2. Names")
    course.follow("3. A key")
    course.follow("4. Install", DEPLOYING)
    with course.second_terminal("5. Start ROS", "started core service"):
        course.until(lambda: all_answer(course.run("pioneer3 fleet list")))
        drive(course)
        course.follow("7. Stop")
        course.follow("9. The next morning")
    course.follow("8. Files")
    assert sorted(path.name for path in (course.folder / "monday").iterdir()) == names


def all_answer(listed: str) -> bool:
    """Whether two nodes and three bridges answer."""
    return listed.count("RosAria_p3at_") == 2 and listed.count("8101 answers") == 3


def test_the_tutorial_works_without_robots(possible: None, tmp_path: Path) -> None:
    with Lab(tmp_path, 0) as lab:
        course = Course(lab, Robots(tmp_path, ()))
        prepare(course)
        section = document.section(TUTORIAL, "10. The same")
        init, _, rest = document.blocks(section)
        course.run(init.text.strip())
        with course.second_terminal("10. The same", "p3at-5"):
            said = [course.run(line) for line in rest.lines]
        assert said[0].count("8101 answers") == 5
        assert said[2].count("stands") == 5


def drive(course: Course) -> None:
    """Press the keys of the tutorial's table, and look at the robots themselves."""
    names = list(course.robots.names)
    text = document.section(TUTORIAL, "6. Drive")
    (line,) = (block.text.strip() for block in document.blocks(text))
    keys = iter(document.keys(text))

    def press(expected: str) -> None:
        key = next(keys)
        assert key == expected
        the.press(key)

    def hold(expected: str, robots: list[str]) -> None:
        key = next(keys)
        assert key == expected
        end = time.monotonic() + PATIENCE
        while course.moving() != robots:
            the.hold(key, 0.2)
            assert time.monotonic() < end, course.moving()
        the.until(lambda: course.moving() == [])

    with terminal(course.lab.operator, line) as the:
        the.sees("5 connected")
        press("a")
        hold("up", names)
        press("2")
        hold("left", names[1:2])
        for key in ("s", "4", "5", "y"):
            press(key)
        hold("up", names[3:])
        press("space")
        press("k")
        the.sees("EMERGENCY STOP is latched")
        press("Ctrl-R")
        press("Ctrl-D")
        assert the.code() == 0
    assert next(keys, None) is None
    assert course.moving() == []
