"""A bridge at a robot, its host at another computer, and a network that breaks."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from pioneer3.arcos import commands, reports
from pioneer3.arcos.packet import PacketReader
from pioneer3.links.tap import FROM_HOST, FROM_ROBOT, read_recording
from pioneer3.log.reader import open_log
from tests.fleet.lab import PATIENCE, ROOT, Computer, Lab

pytestmark = pytest.mark.realtime
QUIET = 4.0
"""How long a quiet host drives before the network breaks [s]."""
LIMIT = 1.5
"""By then the bridge has stopped the robot on a busy machine [s]; the robot's own watchdog would
take 2 s. The benchmark `bridge` has the figures."""


@dataclass
class Events:
    """What a recording of the bridge says, in wall time [s].

    Attributes:
        stops: When the bridge sent STOP.
        speeds: Of the left wheel [mm/s], and when it was reported.
    """

    stops: list[float]
    speeds: list[tuple[float, int]]

    @classmethod
    def of(cls, path: Path) -> "Events":
        first = next(open_log(path).messages(lambda topic: topic.startswith("wire/")))
        began = first.time / 1e9
        readers = {FROM_HOST: PacketReader(), FROM_ROBOT: PacketReader()}
        events = cls([], [])
        for chunk in read_recording(path):
            for payload in readers[chunk.way].feed(chunk.data, chunk.time):
                if chunk.way == FROM_HOST:
                    if isinstance(commands.from_payload(payload), commands.Stop):
                        events.stops.append(began + chunk.time)
                elif isinstance(report := reports.from_payload(payload), reports.Sip):
                    events.speeds.append((began + chunk.time, report.left_speed_raw))
        return events


@contextmanager
def started(computer: Computer, *words: str) -> Iterator["subprocess.Popen[str]"]:
    """Run a program of this checkout on a computer, for the length of a block."""
    process = subprocess.Popen(
        [*computer.inside, "env", f"PYTHONPATH={ROOT / 'src'}:{ROOT}", sys.executable, *words],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()  # what runs in a robot's own processes ends with the lab


def line_with(process: "subprocess.Popen[str]", word: str) -> str:
    """Return the next line of a program's output that contains a word."""
    assert process.stdout is not None
    for line in process.stdout:
        if word in line:
            return line
    raise AssertionError(f"no {word!r} in its output")


@contextmanager
def driven(lab: Lab, recording: Path) -> Iterator["subprocess.Popen[str]"]:
    """Let a quiet host of the operator drive a robot behind a bridge; yield the host."""
    robot = lab.robots[0]
    with ExitStack() as stack:
        sim = stack.enter_context(
            started(robot, "-m", "pioneer3", "sim", "-p", "8101", "-m", "empty", "--ideal")
        )
        line_with(sim, "SIMULATOR")
        words = ("--port", "localhost:8101", "--listen", "8102", "--bind", robot.address)
        bridge = stack.enter_context(
            started(robot, "-m", "pioneer3", "bridge", *words, "--record", str(recording))
        )
        line_with(bridge, "BRIDGE")
        host = stack.enter_context(
            started(lab.operator, "-m", "tests.fleet.quiet_host", robot.address, "8102", "0.3")
        )
        line_with(host, "moves")
        yield host


def until(condition: Callable[[], object], seconds: float = PATIENCE) -> None:
    """Wait until a condition holds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.1)


def test_a_robot_whose_operator_is_cut_off_stops_and_a_quiet_host_is_left_alone(
    lab: Lab, tmp_path: Path
) -> None:
    recording = tmp_path / "bridge.mcap"
    with driven(lab, recording):
        time.sleep(QUIET)
        lab.robots[0].cable.plugged = False
        cut_at = time.time()
        until(lambda: Events.of(recording).speeds[-1][1] == 0)
        events = Events.of(recording)
        began = next(when for when, speed in events.speeds if speed > 200)
        assert not [when for when in events.stops if began < when < cut_at]
        first = next(when for when in events.stops if when > cut_at)
        assert first - cut_at < LIMIT
        time.sleep(1.0)
        assert Events.of(recording).speeds[-1][1] == 0
        lab.robots[0].cable.plugged = True
        until(lambda: Events.of(recording).speeds[-1][1] > 200)


def test_a_host_that_hangs_is_stopped(lab: Lab, tmp_path: Path) -> None:
    recording = tmp_path / "bridge.mcap"
    with driven(lab, recording) as host:
        host.send_signal(signal.SIGSTOP)
        until(lambda: Events.of(recording).speeds[-1][1] == 0)
