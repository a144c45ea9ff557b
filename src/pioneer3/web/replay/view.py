"""A robot of a log as the messages by which pages are told of a driven robot."""

from contextlib import suppress
from math import hypot, isfinite
from typing import Final

from msgspec.structs import replace

from pioneer3.analysis.why import reason_by_readings
from pioneer3.behaviors.engine import Decision
from pioneer3.errors import ConfigError
from pioneer3.geometry import STILL
from pioneer3.maps import LineMap
from pioneer3.navigation.recording import EstimateMade, MapUsed, WayPlanned
from pioneer3.robot.config_table import explained
from pioneer3.robot.explain import LATCHED, Reason
from pioneer3.robot.pilot import stands
from pioneer3.robot.supervisor import Connection
from pioneer3.runtime.recording import DecisionMade, StandsBecause
from pioneer3.web import messages
from pioneer3.web.broadcast import RetainedChannel, Subscriber, sweep
from pioneer3.web.details import details_of
from pioneer3.web.replay.recorded import RecordedRobot
from pioneer3.web.robot_view import robot_part, snapshot_part

WITHIN: Final = 2.448
"""Standard deviations of the circle that holds a position with 95 %."""


def listed(robot: RecordedRobot) -> messages.ListedRobot:
    """Return the part of the hello for a robot."""
    return replace(
        robot_part(robot.number, robot.name, robot.info),
        kind="REPLAY",
        laser=bool(robot.lasers),
        scans=bool(robot.lasers),
        plans=robot.knows_places,
    )


def status(robot: RecordedRobot) -> messages.Status:
    """Return the state of its link at the time."""
    if not robot.is_known:
        return messages.Status(robot.number, Connection.LOST, "The log tells nothing of it then")
    told = robot.link
    if told is None or told.connection is Connection.CLOSED:
        return messages.Status(robot.number, Connection.CONNECTED, "")
    return messages.Status(robot.number, told.connection, told.message)


def snapshot(robot: RecordedRobot) -> messages.SnapshotMessage | None:
    """Return the newest snapshot, with what was decided then."""
    now, made = robot.snapshot, robot.told(DecisionMade)
    if now is None:
        return None
    decision = made.decision if made else None
    decides = decision is not None and decision.wanted and now.stamp < decision.until
    by = made and decision and (made.mode or decision.v_by or decision.w_by)
    way = robot.told(WayPlanned)
    place = way.place if way and way.points else None
    return snapshot_part(
        robot.number,
        now,
        robot_in_map=robot.robot_in_map,
        why=_why(robot),
        emergency_stop=robot.emergency,
        driver=messages.Driver(None, by) if by and decides else None,
        mode=messages.ModeState(made.mode or None, made.told) if made else messages.ModeState(),
        commanded=decision.twist if decision is not None and decides else STILL,
        target=messages.Target(place.x, place.y, place.heading, False) if place else None,
    )


def _why(robot: RecordedRobot) -> Reason | None:
    """Return the reason to stand; older logs tell none, but what was read and decided then."""
    now, made = robot.snapshot, robot.told(DecisionMade)
    if now is None or not stands(now):
        return None
    if (standing := robot.told(StandsBecause)) is not None:
        return standing.reason
    decision = made.decision if made and now.stamp < made.decision.until else Decision()
    return LATCHED if robot.emergency else reason_by_readings(now, decision)


def navigation(robot: RecordedRobot) -> messages.Navigation | None:
    """Return what it knew about its place on the map, and the rest of its way."""
    estimate = robot.told(EstimateMade)
    if estimate is None:
        return None
    here, way = robot.robot_in_map, robot.told(WayPlanned)
    points = way.points if way else ()
    if points:
        nearest = min(
            range(len(points)), key=lambda n: hypot(points[n][0] - here.x, points[n][1] - here.y)
        )
        points = points[nearest:]
    spread = estimate.spread * WITHIN
    return messages.Navigation(
        robot.number,
        sure=estimate.sure,
        reason=estimate.reason,
        agreement=estimate.agreement if isfinite(estimate.agreement) else 0.0,
        place=way.place.name if way and way.place and points else "",
        robot_in_map=estimate.robot_in_map,
        ellipse=(round(spread, 3), round(spread, 3), 0.0) if isfinite(spread) else None,
        way=points,
    )


def sweeps(robot: RecordedRobot) -> list[messages.LaserSweep]:
    """Return the fresh scans of its lasers."""
    now, found = robot.snapshot, []
    if now is None:
        return []
    odom_in_map = robot.robot_in_map @ now.odometry.robot_in_odom.inverse()
    for number, laser in enumerate(robot.lasers):
        scan = robot.scan(laser)
        if scan is not None:
            sensor = odom_in_map @ scan.robot_in_odom @ scan.sensor_in_robot
            found.append(sweep(robot.number, scan, sensor, number))
    return found


def drawn_map(used: MapUsed | None) -> LineMap | None:
    """Return the map of a log; none where it cannot be read."""
    if used is None:
        return None
    with suppress(ConfigError):
        return used.line_map
    return None


class RecordedDetails:
    """Describes one robot to clients that subscribe to its details."""

    def __init__(self, robot: RecordedRobot) -> None:
        self.channel = RetainedChannel()
        self._robot = robot
        self._subscribers: list[Subscriber] = []

    def subscribe(self, client: Subscriber) -> None:
        """Send the details to `client` from now on."""
        self._subscribers.append(client)

    def unsubscribe(self, client: Subscriber) -> None:
        """Send nothing more to `client`; nothing happens if it does not subscribe."""
        self._subscribers = [each for each in self._subscribers if each is not client]

    def request_config(self) -> None:
        """Send the CONFIG that the log has."""
        rows = explained(self._robot.info.config) if self._robot.info.config else ()
        self._put("config", messages.ConfigMessage(self._robot.number, rows, None))

    def publish(self) -> None:
        """Send the details at the time, if anybody subscribes."""
        if self._subscribers:
            now = self._robot.snapshot
            number = self._robot.number
            self._put("details", details_of(number, now) if now else messages.NoDetails(number))

    def _put(self, key: str, message: messages.Message) -> None:
        self.channel.put(key, messages.encode(message))
        for client in self._subscribers:
            client.wake()
