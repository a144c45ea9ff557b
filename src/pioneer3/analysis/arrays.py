"""Messages of a log as arrays with named columns, each described once."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.geometry import wrap
from pioneer3.navigation.recording import EstimateMade
from pioneer3.runtime.recording import DecisionMade
from pioneer3.state import Scan, Snapshot

MOST_NUMBERED: Final = 64
"""Columns of sonars at most: more are damage."""
Row = tuple[Any, ...]
"""Values of the columns of one line, but its time."""


@dataclass(frozen=True, slots=True)
class ArrayColumn:
    """A column: its name, its unit or meaning, and NumPy's type of its values."""

    name: str
    about: str
    kind: str = "f8"


@dataclass(frozen=True, slots=True, kw_only=True)
class ArrayTable:
    """The columns that messages of a topic are put into, besides `time`.

    Attributes:
        lines: Returns the values of a message.
        stamped: Whether the messages tell when they were measured.
        numbered: Whether its column is there for each value of a message.
    """

    name: str
    topic: str
    about: str
    columns: tuple[ArrayColumn, ...]
    lines: Callable[[Any], Row]
    stamped: bool = False
    numbered: bool = False


TIME: Final = ArrayColumn("time", "s since the log began")
X: Final = ArrayColumn("x", "m")
Y: Final = ArrayColumn("y", "m")
HEADING: Final = ArrayColumn("heading", "rad")
SPEED: Final = ArrayColumn("v", "m/s")
TURN_RATE: Final = ArrayColumn("w", "rad/s")
POSE: Final = ("x", "y", "theta")
"""Fields of a pose."""
TWIST: Final = ("twist.v", "twist.w")
"""Fields of a velocity in a message."""
LINK: Final = (
    ArrayColumn("rate", "reports/s"),
    ArrayColumn("bad_checksums", "frames that were dropped in this session", "i8"),
    ArrayColumn("bytes_skipped", "bytes of no frame in this session", "i8"),
    ArrayColumn("sessions", "connections so far", "i8"),
)
"""Columns of the link; they are the fields of a snapshot's link."""


def _battery(snapshot: Snapshot) -> Row:
    battery = snapshot.battery
    charge = np.nan if battery.charge is None else battery.charge
    return battery.voltage, charge, battery.low, battery.charging.value


def _motors(snapshot: Snapshot) -> Row:
    motors, bumpers = snapshot.motors, snapshot.bumpers
    stalls = motors.left_stalled, motors.right_stalled
    return motors.enabled, *stalls, motors.stop_button, any((*bumpers.front, *bumpers.rear))


def _decision(made: DecisionMade) -> Row:
    decision = made.decision
    by = decision.v_by or "", decision.w_by or ""
    return made.mode, decision.twist.v, decision.twist.w, *by


def _estimate(estimate: EstimateMade) -> Row:
    pose = estimate.robot_in_map
    place = attrgetter(*POSE)(pose) if pose else [np.nan] * 3
    return *place, estimate.sure, estimate.spread, estimate.map


TABLES: Final = (
    ArrayTable(
        name="odometry",
        topic="snapshot",
        about="Pose and velocity by the wheels",
        columns=(
            *(X, Y, HEADING, SPEED, TURN_RATE),
            ArrayColumn("left_speed", "m/s, of the left wheel over ground"),
            ArrayColumn("right_speed", "m/s"),
        ),
        lines=attrgetter(
            *(f"odometry.robot_in_odom.{each}" for each in POSE),
            *(f"odometry.{each}" for each in (*TWIST, "left_speed", "right_speed")),
        ),
        stamped=True,
    ),
    ArrayTable(
        name="battery",
        topic="snapshot",
        about="The battery and its charger",
        columns=(
            ArrayColumn("voltage", "V"),
            ArrayColumn("charge", "0 to 1; NaN where the robot does not send it"),
            ArrayColumn("low", "below the robot's own alarm level", "?"),
            ArrayColumn("charging", "state of the charger", "O"),
        ),
        lines=_battery,
        stamped=True,
    ),
    ArrayTable(
        name="sonar",
        topic="snapshot",
        about="Ranges of the sonars: `inf` where nothing echoed, NaN before the first reading",
        columns=(ArrayColumn("range_0", "m; `range_1` ...: as many as the robot has"),),
        lines=lambda snapshot: snapshot.sonar.ranges,
        stamped=True,
        numbered=True,
    ),
    ArrayTable(
        name="motors",
        topic="snapshot",
        about="Motors, wheels that are blocked, stop button and bumpers",
        columns=(
            ArrayColumn("enabled", "the motors have power", "?"),
            ArrayColumn("left_stalled", "the left wheel is blocked", "?"),
            ArrayColumn("right_stalled", "the right one", "?"),
            ArrayColumn("stop_button", "the button on the robot is pressed", "?"),
            ArrayColumn("bumped", "a bumper touches something", "?"),
        ),
        lines=_motors,
        stamped=True,
    ),
    ArrayTable(
        name="link",
        topic="snapshot",
        about="Quality of the reception",
        columns=LINK,
        lines=attrgetter(*(f"link.{each.name}" for each in LINK)),
        stamped=True,
    ),
    ArrayTable(
        name="decision",
        topic="decision",
        about="The velocity that was wanted; a line holds until the next one",
        columns=(
            ArrayColumn("mode", "that drives, or empty", "O"),
            *(SPEED, TURN_RATE),
            ArrayColumn("v_by", "first action that decided the speed", "O"),
            ArrayColumn("w_by", "first action that decided the turn", "O"),
        ),
        lines=_decision,
    ),
    ArrayTable(
        name="command",
        topic="command",
        about="What was asked of the robot, and by whom",
        columns=(
            ArrayColumn("by", "an input, such as `keyboard` or `program`", "O"),
            ArrayColumn("command", "such as `drive`", "O"),
            *(SPEED, TURN_RATE),
            ArrayColumn("seconds", "s, for how long"),
            ArrayColumn("refused", "the reason, or empty", "O"),
        ),
        lines=attrgetter("by", "command", *TWIST, "seconds", "refused"),
    ),
    ArrayTable(
        name="estimate",
        topic="estimate",
        about="Where the robot is on its map; a line holds until the next one",
        columns=(
            *(X, Y, HEADING),
            ArrayColumn("sure", "whether the robot may act upon it", "?"),
            ArrayColumn("spread", "m, standard deviation in its worst direction"),
            ArrayColumn("map", "name of the map", "O"),
        ),
        lines=_estimate,
    ),
    ArrayTable(
        name="truth",
        topic="truth",
        about="True pose of a simulated robot",
        columns=(X, Y, HEADING),
        lines=attrgetter(*(f"robot_in_world.{each}" for each in POSE)),
    ),
    ArrayTable(
        name="goal",
        topic="goal",
        about="Changes of goals",
        columns=(
            ArrayColumn("number", "of the goal", "i8"),
            ArrayColumn("by", "user of the page, `program` or `ROS`", "O"),
            ArrayColumn("status", "such as `accepted` or `succeeded`", "O"),
            ArrayColumn("reason", "of its end, or of a wait on the way", "O"),
        ),
        lines=attrgetter("number", "by", "status", "reason"),
    ),
    ArrayTable(
        name="event",
        topic="event",
        about="What happened to links, clocks and the log",
        columns=(ArrayColumn("kind", "such as `link`", "O"), ArrayColumn("text", "in words", "O")),
        lines=attrgetter("kind", "text"),
    ),
)
"""Arrays that have a line for each message."""
SCANS: Final = ArrayTable(
    name="scan",
    topic="scan/laser",
    about="Readings of a laser, a line for each; of a second one `scan/laser2`",
    columns=(
        ArrayColumn("sequence", "number of the scan", "i8"),
        ArrayColumn("angle", "rad, in the laser's frame"),
        ArrayColumn("range", "m; `inf`: no echo, `-inf`: too near, NaN: not valid"),
        ArrayColumn("x", "m, of the echo in odometry's frame; NaN without one"),
        Y,
    ),
    lines=lambda scan: scan.ranges,
    stamped=True,
)
"""Array that has a line for each reading of a scan."""


def table_of(name: str) -> ArrayTable:
    """Return the table of an array such as `odometry` or `scan/laser2`.

    Raises:
        ConfigError: There is none.
    """
    if name.partition("/")[0] == SCANS.name:
        return replace(SCANS, topic=name if "/" in name else SCANS.topic)
    for table in TABLES:
        if table.name == name:
            return table
    known = ", ".join(each.name for each in (*TABLES, SCANS))
    raise ConfigError(f"no array {name!r}; there are: {known}")


def array_of(table: ArrayTable, messages: Iterable[tuple[float, Any]]) -> NDArray[Any]:
    """Return messages with their times as an array.

    Raises:
        ValueError: They are damaged.
    """
    if table.name == SCANS.name:
        found = [_readings(time, scan) for time, scan in messages]
        return np.concatenate([np.empty(0, _type(SCANS.columns)), *found])
    lines = [(time, *table.lines(message)) for time, message in messages]
    if not table.numbered:
        return np.array(lines, dtype=_type(table.columns))
    width = max((len(line) - 1 for line in lines), default=0)
    if width > MOST_NUMBERED:
        raise ValueError(f"{table.name} of {width} columns")
    whole = [(*line, *[np.nan] * (width + 1 - len(line))) for line in lines]
    return np.array(whole, dtype=_type(_numbered(table.columns[0], width)))


def _type(columns: Iterable[ArrayColumn]) -> list[tuple[str, str]]:
    return [(each.name, each.kind) for each in (TIME, *columns)]


def _numbered(first: ArrayColumn, width: int) -> Iterator[ArrayColumn]:
    stem = first.name.removesuffix("0")
    return (ArrayColumn(f"{stem}{number}", first.about) for number in range(width))


def _readings(time: float, scan: Scan) -> NDArray[Any]:
    """Return the readings of a scan that began at a time, each from where the robot was at its."""
    place = np.arange(len(scan.ranges))
    share = place / max(len(place) - 1, 1)
    begin = scan.sensor_in_odom
    end = scan.last_in_odom @ scan.sensor_in_robot if scan.last_in_odom else begin
    array = np.empty(len(place), dtype=_type(SCANS.columns))
    array["time"] = time + scan.beam_time * place
    array["sequence"], array["angle"], array["range"] = scan.sequence, scan.angles, scan.ranges
    ranges = np.where(np.isfinite(array["range"]), array["range"], np.nan)
    bearing = begin.theta + share * wrap(end.theta - begin.theta) + array["angle"]
    array["x"] = begin.x + share * (end.x - begin.x) + ranges * np.cos(bearing)
    array["y"] = begin.y + share * (end.y - begin.y) + ranges * np.sin(bearing)
    return array
