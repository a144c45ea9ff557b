"""Faults of one robot's computer while one keyboard drives five: real computers, ROS and systemd.

The robots are simulated at serial ports, in a process of their own: they go on when a computer
hangs, as a robot does. How soon one stands is the truth of the simulator, not a report.
"""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from sysconfig import get_path
from typing import Final

import pytest

from pioneer3.fleet.inventory import read_fleet
from pioneer3.fleet.unit import unit_of
from tests.fleet.lab import PATIENCE, ROOT, USER, Lab, OnBoard
from tests.fleet.manager import as_user, managed, why_no_manager
from tests.fleet.robots import DEVICE, Robots, plugged_in, preferred
from tests.fleet.terminal import Terminal, terminal
from tests.ros1.master import has_ros

pytestmark = [pytest.mark.realtime, pytest.mark.thorough, pytest.mark.timeout(300)]
EXPIRY, WATCHDOG = 0.7, 2.2
"""Longest time from a fault until the robot stands [s]: by a velocity that expires on its computer,
and by the robot's own watchdog."""
BUSY: Final = 0.5
"""Allowance for a machine that is busy with other work [s]."""
FURTHER: Final = 0.25
"""Longest way after the key is let go, over a network that delays and loses packets [m]."""


@dataclass
class Drive:
    """Five robots that one keyboard drives.

    Attributes:
        lab: The computers.
        robots: At their serial ports.
        screen: Of `fleet drive`.
    """

    lab: Lab
    robots: Robots
    screen: Terminal

    def row(self, robot: OnBoard) -> str:
        """Return the row of a robot in the table."""
        self.screen.read()
        return next((line for line in self.screen.screen if f" {robot.name} " in line), "")

    def moving(self) -> list[str]:
        return [name for name in self.robots.names if not self.robots.now(name).stands]

    def all_move(self) -> None:
        """Press the key until all robots move; who was lost waits until it is pressed anew."""
        end = time.monotonic() + PATIENCE
        while True:
            self.screen.hold("up", 1.0)
            if len(self.moving()) == len(self.robots.names):
                return
            assert time.monotonic() < end, "\n".join(self.screen.screen)
            self.screen.read(1.0)

    def others_went_on(self, faulty: OnBoard, since: float) -> None:
        """Check that no other robot has stood since a time, while the key was held."""
        for name in self.robots.names:
            if name != faulty.name:
                instants = self.robots.truth(name, since)
                stood = [instant for instant in instants if instant.stands]
                assert not stood, f"{name} stood {stood[0].time - since:.2f} s after the fault"
                assert instants[-1].travelled - instants[0].travelled > 0.1


def write_fleet(lab: Lab) -> None:
    """Two robots have ROS, the others a bridge."""
    lab.write_fleet(port=DEVICE)
    text = (
        (lab.operator.home / "fleet.toml")
        .read_text()
        .replace("[defaults]", "[defaults]\nbridge = 8101")
    )
    for robot in lab.robots[:2]:
        address = f'address = "{robot.address}"'
        text = text.replace(address, f'{address}\nros = "1"')
    (lab.operator.home / "lab/fleet.toml").write_text(text)


def serve(lab: Lab, robot: OnBoard) -> None:
    """Run the service of a robot, with the unit that `fleet deploy` would write."""
    fleet = read_fleet(lab.operator.home / "lab/fleet.toml")
    python = robot.folder / "python"
    packages = f"{ROOT / 'src'}:{get_path('purelib')}"
    python.write_text(f'#!/bin/sh\nPYTHONPATH={packages} exec /usr/bin/python3 "$@"\n')
    python.chmod(0o755)
    robot.sh(f"touch /run/python; mount --bind {python} /run/python")
    unit = unit_of(fleet.robot(robot.name), fleet, "/run/python", with_root=False).text()
    folder = robot.user_home / ".config/systemd/user"
    subprocess.run(as_user(robot, "mkdir", "-p", f"/home/{USER}/.config/systemd/user"), check=True)
    (folder / "pioneer3.service").write_text(unit)
    for words in (("daemon-reload",), ("start", "pioneer3")):
        subprocess.run(as_user(robot, "systemctl", "--user", *words), check=True)


@pytest.fixture(scope="module")
def driving(possible: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Drive]:
    """Five robots behind their services, and `fleet drive` with all of them chosen."""
    if reason := why_no_manager():
        pytest.skip(reason)
    if not has_ros():
        pytest.skip("ROS 1 is not installed; scripts/test installs it")
    folder = tmp_path_factory.mktemp("faults")
    with ExitStack() as stack:
        stack.enter_context(preferred())
        lab = stack.enter_context(Lab(folder, 5))
        operator = lab.operator
        (operator.home / "lab").mkdir()
        write_fleet(lab)
        operator.sh(f"printf '127.0.0.1 localhost\\n{operator.address} laptop\\n' >/etc/hosts")
        operator.install("pioneer3", f'exec {sys.executable} -m pioneer3 "$@"')
        robots = stack.enter_context(plugged_in(lab.robots, folder))
        stack.enter_context(managed(lab.robots))
        stack.enter_context(terminal(operator, "roscore")).sees("started core service")
        for robot in lab.robots:
            serve(lab, robot)
        screen = stack.enter_context(terminal(operator, "pioneer3 fleet drive"))
        screen.sees("5 connected")
        screen.press("a")
        yield Drive(lab, robots, screen)
        screen.press("Ctrl-D")
        screen.code()


@pytest.fixture
def drive(driving: Drive) -> Iterator[Drive]:
    """All five robots move; what a test has broken is mended after it."""
    driving.all_move()
    yield driving
    for robot in driving.lab.robots:
        robot.thaw()
        robot.cable.plugged, robot.cable.loss, robot.cable.delay = True, 0.0, 0.0
    driving.screen.until(lambda: "5 connected" in driving.screen.screen[0])
    driving.screen.until(lambda: driving.moving() == [])


def cut_off(robot: OnBoard) -> None:
    robot.cable.plugged = False


def hang(robot: OnBoard) -> None:
    robot.freeze()


def kill(robot: OnBoard) -> None:
    (service,) = robot.processes("-m pioneer3 ")
    os.kill(service, signal.SIGKILL)


NODE, BRIDGE = 1, 3
"""Indices of a robot whose node of ROS is driven, and of one at a bridge."""


@pytest.mark.parametrize("number", [NODE, BRIDGE], ids=["node", "bridge"])
@pytest.mark.parametrize(
    ("fault", "soonest"),
    [(cut_off, EXPIRY), (hang, WATCHDOG), (kill, WATCHDOG)],
    ids=["cut off", "hangs", "killed"],
)
def test_a_robot_with_a_fault_stands_by_itself_and_the_others_go_on(
    drive: Drive, fault: Callable[[OnBoard], None], soonest: float, number: int
) -> None:
    faulty = drive.lab.robots[number]
    since = time.monotonic()
    fault(faulty)
    seen = ""
    while time.monotonic() < since + 3.5:
        drive.screen.hold("up", 0.2)
        seen = max(seen, told(drive.row(faulty)), key=len)
    stood = drive.robots.stood(faulty.name, since, since + 3.5)
    sys.stdout.write(f"{faulty.name} stood after {stood} s: {seen}\n")
    drive.others_went_on(faulty, since)
    assert stood is not None
    assert stood < soonest + BUSY
    assert "lost" in seen


def told(row: str) -> str:
    """Return the state and the reason in a row; empty if the robot is connected."""
    return "" if "connected" in row else row.partition("p3at-")[2]


def test_a_robot_that_was_cut_off_waits_for_a_fresh_key(drive: Drive) -> None:
    cut = drive.lab.robots[BRIDGE]
    cut_off(cut)
    drive.screen.until(lambda: "lost" in drive.row(cut))
    drive.screen.until(lambda: drive.moving() == [])  # nobody holds the key
    cut.cable.plugged = True
    drive.screen.until(lambda: "connected" in drive.row(cut))
    drive.screen.read(1.0)
    assert drive.moving() == []
    drive.all_move()


@pytest.mark.parametrize("number", [NODE, BRIDGE], ids=["node", "bridge"])
@pytest.mark.parametrize(("loss", "delay"), [(0.3, 0.0), (0.0, 0.5)], ids=["loss", "delay"])
def test_a_bad_network_spoils_one_robot_and_moves_it_no_further_than_its_keys(
    drive: Drive, loss: float, delay: float, number: int
) -> None:
    faulty = drive.lab.robots[number]
    faulty.cable.loss, faulty.cable.delay = loss, delay
    since = time.monotonic()
    drive.screen.hold("up", 4.0)
    drive.others_went_on(faulty, since)
    let_go, there = time.monotonic(), drive.robots.now(faulty.name).travelled
    drive.screen.read(4.0)
    stood = drive.robots.stood(faulty.name, let_go)
    further = drive.robots.now(faulty.name).travelled - there
    sys.stdout.write(f"{faulty.name} stood {stood} s after the key, {further} m further on\n")
    assert drive.moving() == []
    assert further < FURTHER


COMMANDS = (
    "list --timeout 2",
    "stop --timeout 4",
    "run --timeout 4 hostname",
    "push --timeout 4 fleet.toml there.toml",
    "pull --timeout 4 there.toml --to monday",
    "status --timeout 4",
    "doctor --timeout 4",
    "logs --timeout 4",
    "key --timeout 4",
)


def test_no_command_waits_for_a_computer_that_hangs(drive: Drive) -> None:
    well, hung = drive.lab.robots[2], drive.lab.robots[NODE]
    hung.freeze()
    for command in COMMANDS:
        began = time.monotonic()
        done = subprocess.run(
            drive.lab.operator.in_lab("pioneer3", "fleet", *command.split()),
            capture_output=True,
            text=True,
            env=drive.lab.operator.environment,
            timeout=PATIENCE,
            check=False,
        )
        took = time.monotonic() - began
        said = done.stdout + done.stderr
        sys.stdout.write(f"fleet {command}: {took:.1f} s\n{said}")
        assert took < 20, said
        assert well.name in said
        assert hung.name in said
        assert done.returncode == 1 or command.startswith("list"), said
