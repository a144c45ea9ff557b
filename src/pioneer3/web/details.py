"""What the robot view shows beyond a snapshot: slower, and for those only who have it open."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict
from typing import Any

from pioneer3.arcos.commands import IoRequest
from pioneer3.arcos.commands import Request as How
from pioneer3.arcos.reports import Io, Report
from pioneer3.doctor.facts import Finding, Level
from pioneer3.doctor.watch import LineWatch
from pioneer3.errors import CommandError, PioneerError
from pioneer3.robot.config_table import explained
from pioneer3.robot.devices import detailed_status
from pioneer3.robot.devices.gyro import Gyro
from pioneer3.robot.devices.lines import LinesReading, read_io
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.runtime.robot import Robot
from pioneer3.state import Snapshot
from pioneer3.web import messages
from pioneer3.web.channel import Notices
from pioneer3.web.guest import Guest
from pioneer3.web.scene import Scene

PERIOD = 0.5
"""Between two messages [s]."""
LINES_PERIOD = 1.0
"""The controller is asked for all its lines so often [s]: slow lines have no room for more."""
LINES_AGE = 3.0
"""What was said longer ago than this counts no more [s]."""
CONFIG_PERIOD = 5.0
"""And for CONFIG no more often than this [s], whoever asks."""


class Details:
    """Describes one robot, once for everybody who looks.

    Args:
        number: Of the robot, for the messages.
        robot: What is described.
        scene: Where it is.

    Attributes:
        notices: What those are told who watch.
    """

    def __init__(self, number: int, robot: Robot, scene: Scene) -> None:
        self.notices = Notices()
        self._number, self._robot, self._scene = number, robot, scene
        self._line = LineWatch(robot.supervisor)
        self._lines: LinesReading | None = None
        self._clock = asyncio.get_running_loop().time
        self._lines_asked_at = self._config_asked_at = float("-inf")
        self._guests: list[Guest] = []
        self._watched, self._config_wanted = asyncio.Event(), asyncio.Event()

    def watch(self, guest: Guest) -> None:
        """Tell `guest`, from now on."""
        self._guests.append(guest)
        self._watched.set()

    def unwatch(self, guest: Guest) -> None:
        """Tell `guest` no more, if they were told at all."""
        self._guests = [each for each in self._guests if each is not guest]

    def want_config(self) -> None:
        """Tell CONFIG to those who watch; the robot is asked for it unless that was just done."""
        self._config_wanted.set()

    async def run(self) -> None:
        """Tell those who watch how it is, while there are any; ends by cancellation."""
        while True:
            await self._watched.wait()
            with self._listening():
                while self._guests:
                    now = self._clock()
                    self._ask_for_lines(now)
                    self._tell("details", self._describe(now))
                    await asyncio.sleep(PERIOD)
            self.notices.forget("details")
            self._watched.clear()

    async def ask(self) -> None:
        """Ask for CONFIG when somebody wants it; ends by cancellation."""
        while True:
            await self._config_wanted.wait()
            self._config_wanted.clear()
            error = None
            if self._clock() - self._config_asked_at > CONFIG_PERIOD:
                try:
                    await self._robot.devices.configuration()
                    self._config_asked_at = self._clock()
                except PioneerError as failure:
                    error = str(failure)
            info = self._robot.supervisor.info
            rows = explained(info.config) if info and info.config else ()
            message = {"type": "config", "robot": self._number, "rows": rows, "error": error}
            self._tell("config", message)

    def _tell(self, key: str, message: dict[str, Any]) -> None:
        self.notices.forget(key)  # an answer is told even if it is the same as before
        self.notices.put(key, messages.encode(message))
        for guest in self._guests:
            guest.wake()

    @contextmanager
    def _listening(self) -> Iterator[None]:
        """Listen to what is sent only to who asks for it, during the block."""
        forget = self._robot.supervisor.reports.hand_to(self._take, Io)
        try:
            with _streaming(self._robot.devices.gyro):
                yield
        finally:
            forget()

    def _describe(self, now: float) -> dict[str, Any]:
        info, snapshot = self._robot.supervisor.info, self._robot.snapshot
        about = {"type": "details", "robot": self._number}
        if info is None or snapshot is None:
            return about | {"known": False}
        return (
            about
            | {"known": True, "findings": self._findings(now)}
            | _about_motion(self._robot, snapshot)
            | _about_state(snapshot)
            | _about_link(info, snapshot)
            | {"lines": self._about_lines(snapshot, now), "gyro": self._about_gyro()}
        )

    def _findings(self, now: float) -> list[Finding]:
        if self._scene.simulated:
            pace = self._scene.simulated[0].pace
            if pace.paused or pace.speed != 1:
                how = "is paused" if pace.paused else f"passes {pace.speed:g} times as fast"
                found = f"simulated time {how}: reports keep to that, and are not judged"
                return [Finding(check="reports", level=Level.OK, found=found)]
        return list(self._line.findings(now))

    def _about_lines(self, snapshot: Snapshot, now: float) -> dict[str, Any]:
        inputs, read = snapshot.inputs, self._lines
        if read is not None and now - read.stamp > LINES_AGE:
            read = None
        return {
            "digital_in": read.digital_in if read else _bits(inputs.digital_in),
            "digital_out": read.digital_out if read else _bits(inputs.digital_out),
            "analog": read.analog if read else None,
            "selected": {"port": inputs.analog_port, "voltage": inputs.analog},
        }

    def _about_gyro(self) -> dict[str, Any]:
        gyro = self._robot.devices.gyro
        reading = gyro.latest
        return {
            "words": gyro.presence.reason,
            "heading": reading.heading if reading else None,
            "rate": reading.rate if reading else None,
        }

    def _ask_for_lines(self, now: float) -> None:
        if self._robot.snapshot is not None and now - self._lines_asked_at >= LINES_PERIOD:
            self._lines_asked_at = now
            with suppress(CommandError):  # the link may just have been lost
                self._robot.send(IoRequest(How.ONCE))

    def _take(self, report: Report, stamp: float) -> None:
        if isinstance(report, Io):
            self._lines = read_io(report, stamp)


@contextmanager
def _streaming(gyro: Gyro) -> Iterator[None]:
    """Let a gyro that is there send its samples during the block."""
    if not gyro.presence.there:
        yield
        return
    with gyro.wanted():
        yield


def _about_motion(robot: Robot, now: Snapshot) -> dict[str, Any]:
    odometry, sent = now.odometry, robot.supervisor.pilot.sent
    return {
        "pose": odometry.robot_in_odom,
        "encoder": odometry.robot_in_encoder,
        "twist": odometry.twist,
        "commanded": sent,
        "wheels": {"left": odometry.left_speed, "right": odometry.right_speed},
    }


def _about_state(now: Snapshot) -> dict[str, Any]:
    status = detailed_status(now)
    return {
        "stalls": {"left": now.motors.left_stalled, "right": now.motors.right_stalled},
        "temperature": now.inputs.temperature,
        "compass": now.inputs.compass,
        "flags": status.flags,
        "faults": status.faults,
        "charger_power": status.charger_power,
    }


def _about_link(info: RobotInfo, now: Snapshot) -> dict[str, Any]:
    return {"link": {"url": info.url, "speed": info.speed, **asdict(now.link)}}


def _bits(byte: int) -> list[bool]:
    return [bool(byte >> bit & 1) for bit in range(8)]
