"""Details of a robot beyond its snapshots: slower, and for clients only that subscribe to them."""

import asyncio
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Any

from pioneer3.arcos.commands import IoRequest, RequestMode
from pioneer3.arcos.reports import Io, Report
from pioneer3.doctor.facts import Finding, failure, ok, warning
from pioneer3.doctor.watch import LineWatch
from pioneer3.errors import CommandError, PioneerError, Symptom
from pioneer3.robot.config_table import explained
from pioneer3.robot.devices import detailed_status
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.robot.devices.lines import LinesReading, read_io
from pioneer3.robot.devices.sensor import Sensor
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.runtime.robot import Robot
from pioneer3.state import Snapshot
from pioneer3.tasks import next_tick
from pioneer3.web import messages
from pioneer3.web.broadcast import RetainedChannel, Subscriber
from pioneer3.web.scene import RobotScene

if TYPE_CHECKING:
    from pioneer3.runtime.shadow import Shadow

PERIOD = 0.5
"""Between two messages [s]."""
LINES_PERIOD = 1.0
"""The controller is asked for all its lines so often [s]: slow lines have no room for more."""
LINES_AGE = 3.0
"""Older reports of the lines are not shown [s]."""
CONFIG_PERIOD = 5.0
"""The robot is asked for CONFIG no more often than this [s]."""


class RobotDetails:
    """Describes one robot, once for all subscribers to the channel of details and CONFIG."""

    def __init__(self, number: int, robot: Robot, scene: RobotScene) -> None:
        self.channel = RetainedChannel()
        self._number, self._robot, self._scene = number, robot, scene
        self._line = LineWatch(robot.supervisor)
        self._lines: LinesReading | None = None
        self._clock = asyncio.get_running_loop().time
        self._lines_asked_at = self._config_asked_at = float("-inf")
        self._subscribers: list[Subscriber] = []
        self._subscribed, self._config_wanted = asyncio.Event(), asyncio.Event()

    def subscribe(self, client: Subscriber) -> None:
        """Send the details to `client` from now on."""
        self._subscribers.append(client)
        self._subscribed.set()

    def unsubscribe(self, client: Subscriber) -> None:
        """Send nothing more to `client`; nothing happens if it does not subscribe."""
        self._subscribers = [each for each in self._subscribers if each is not client]

    def request_config(self) -> None:
        """Send CONFIG to the subscribers; the robot is asked for it unless that was just done."""
        self._config_wanted.set()

    async def run(self) -> None:
        """Send details while there are subscribers; ends by cancellation."""
        while True:
            await self._subscribed.wait()
            with self._listening():
                while self._subscribers:
                    now = self._clock()
                    self._ask_for_lines(now)
                    self._publish("details", self._describe(now))
                    await next_tick(PERIOD)
            self.channel.forget("details")
            self._subscribed.clear()

    async def ask(self) -> None:
        """Ask the robot for CONFIG when that is requested; ends by cancellation."""
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
            self._publish("config", messages.ConfigMessage(self._number, rows, error))

    def _publish(self, key: str, message: messages.Message) -> None:
        self.channel.forget(key)  # an answer is sent even if it is the same as before
        self.channel.put(key, messages.encode(message))
        for client in self._subscribers:
            client.wake()

    @contextmanager
    def _listening(self) -> Iterator[None]:
        """Receive the reports that the robot sends on request only, during the block."""
        forget = self._robot.supervisor.reports.hand_to(self._take, Io)
        try:
            with ExitStack() as streams:
                for sensor in self._robot.devices.sensors:
                    if sensor.presence.there:
                        streams.enter_context(sensor.wanted())
                yield
        finally:
            forget()

    def _describe(self, now: float) -> messages.Details | messages.NoDetails:
        info, snapshot = self._robot.supervisor.info, self._robot.snapshot
        if info is None or snapshot is None:
            return messages.NoDetails(self._number)
        return details_of(
            self._number,
            snapshot,
            findings=(
                *self._findings(now),
                *shadow_findings(self._robot.shadow),
                *laser_findings(self._robot.lasers),
            ),
            baud=info.speed,
            read=self._fresh_lines(now),
            sensors=tuple(map(_sensor, self._robot.devices.sensors)),
        )

    def _findings(self, now: float) -> list[Finding]:
        if self._scene.simulated:
            pace = self._scene.simulated[0].pace
            if pace.paused or pace.speed != 1:
                how = "is paused" if pace.paused else f"passes {pace.speed:g} times as fast"
                found = f"simulated time {how}: reports keep to that, and are not judged"
                return [ok("reports", found)]
        return list(self._line.findings(now))

    def _fresh_lines(self, now: float) -> LinesReading | None:
        read = self._lines
        return None if read is None or now - read.stamp > LINES_AGE else read

    def _ask_for_lines(self, now: float) -> None:
        if self._robot.snapshot is not None and now - self._lines_asked_at >= LINES_PERIOD:
            self._lines_asked_at = now
            with suppress(CommandError):  # the link may just have been lost
                self._robot.send(IoRequest(RequestMode.ONCE))

    def _take(self, report: Report, stamp: float) -> None:
        if isinstance(report, Io):
            self._lines = read_io(report, stamp)


def details_of(
    number: int,
    snapshot: Snapshot,
    *,
    findings: tuple[Finding, ...] = (),
    baud: int | None = None,
    read: LinesReading | None = None,
    sensors: tuple[messages.SensorDetails, ...] = (),
) -> messages.Details:
    """Return the message about a robot; its lines as they were `read`, else as snapshots say."""
    odometry, motors, status = snapshot.odometry, snapshot.motors, detailed_status(snapshot)
    inputs = snapshot.inputs
    return messages.Details(
        robot=number,
        findings=findings,
        robot_in_encoder=odometry.robot_in_encoder,
        wheels=messages.Sides(odometry.left_speed, odometry.right_speed),
        stalls=messages.Stalls(motors.left_stalled, motors.right_stalled),
        temperature=inputs.temperature,
        compass=inputs.compass,
        flags=status.flags,
        faults=status.faults,
        charger_power=status.charger_power,
        baud=baud,
        lines=messages.LineValues(
            read.digital_in if read else _bits(inputs.digital_in),
            read.digital_out if read else _bits(inputs.digital_out),
            read.analog if read else None,
            messages.AnalogPort(inputs.analog_port, inputs.analog),
        ),
        sensors=sensors,
    )


def shadow_findings(shadow: "Shadow | None") -> Iterator[Finding]:
    """Yield whether the robot does what its twin does."""
    if shadow is None:
        return
    if (parting := shadow.parting) is None:
        yield ok("twin", "it does what its twin does")
    else:
        yield warning(
            check="twin",
            found=parting.text,
            meaning="A simulated twin that is told the same is elsewhere: it is drawn on the map.",
        )


def laser_findings(lasers: Iterable[LaserSource]) -> Iterator[Finding]:
    """Yield the state of each laser range finder at the computer."""
    for laser in lasers:
        if not isinstance(laser, LaserDriver):
            continue
        if laser.connected:
            found = f"{laser.title}: {laser.rate:.0f} scans/s"
            yield ok(laser.name, found)
        else:
            advice = "is it switched on and plugged in? It is looked for again and again"
            yield failure(
                check=laser.name, found=str(laser.presence), advice=advice, symptom=Symptom.NO_LASER
            )


def _sensor(sensor: Sensor[Any]) -> messages.SensorDetails:
    reading, kind = sensor.latest, sensor.kind
    values = (messages.SensorValue(shown.label, shown.text(reading)) for shown in kind.shown)
    words = sensor.presence.reason
    return messages.SensorDetails(kind.name, words, () if reading is None else tuple(values))


def _bits(byte: int) -> tuple[bool, ...]:
    return tuple(bool(byte >> bit & 1) for bit in range(8))
