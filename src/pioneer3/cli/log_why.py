"""`pioneer3 log why`: the reason that a robot stood or moved at a time, as its log has it."""

from collections.abc import Iterator
from datetime import timedelta
from math import degrees
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.options import Flag, LogName, RobotName
from pioneer3.cli.process import write_json
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from pioneer3.analysis.open_log import OpenLog
    from pioneer3.analysis.why import MomentTold
    from pioneer3.runtime.recording import CommandGiven


def why(
    name: LogName = "",
    /,
    *,
    at: Annotated[str | None, Parameter(metavar="TIME", show_default=False)] = None,
    robot: RobotName = None,
    json: Flag = False,
) -> int:
    """Explain a robot's motion or standstill at a time, by the wishes of its actions.

    Example: pioneer3 log why drive --at 14:02:31
    Example: pioneer3 log why drive --at 90s

    Args:
        name: A file, or a part of the log's name; without it, the newest.
        at: A time of day, or how long after the log began; without it, its end.
        robot: Of a log of several.
        json: Print JSON.
    """
    from rich.table import Table

    from pioneer3.analysis.why import told_at
    from pioneer3.cli.terminal import Terminal
    from pioneer3.names import printable

    log = opened(name, robot)
    told = told_at(log, _seconds(log, at))
    if json:
        write_json(told)
        return 0
    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True)
    grid.add_column(overflow="fold")
    for label, words in _rows(log, told):
        grid.add_row(label, printable(words))
    Terminal().print(grid)
    return 0


def opened(name: str, robot: str | None) -> "OpenLog":
    """Open a log, or the part about one robot; several have to be told apart.

    Raises:
        ConfigError: There is no such log or robot, or it has several, and none is named.
    """
    from pioneer3.log import open as open_log

    log = open_log(name)
    if robot is not None:
        return log.robot(robot)
    if len(log.robots) > 1:
        raise ConfigError(f"{log.path.name} has several robots: --robot {' or '.join(log.robots)}")
    return log


def _seconds(log: "OpenLog", at: str | None) -> float:
    from pioneer3.log.moment import time_of

    known = log.info()
    if at is None:
        return known.seconds
    try:
        seconds = (time_of(at, known.began) - known.began) / 1e9
    except ConfigError as error:
        raise ConfigError(f"--at {error}") from None
    if not 0 <= seconds <= known.seconds:
        end = (log.began + timedelta(seconds=known.seconds)).astimezone()
        raise ConfigError(
            f"--at {at}: the log is from {log.began:%H:%M:%S} to {end:%H:%M:%S}, "
            f"{known.seconds:.1f} s"
        )
    return seconds


def _rows(log: "OpenLog", told: "MomentTold") -> Iterator[tuple[str, str]]:
    """Yield labels and words."""
    from pioneer3.analysis.why import GONE
    from pioneer3.robot.explain import advised

    def ago(time: float) -> str:
        return f"{max(0.0, told.time - time):.1f} s before"

    yield "log", log.path.name
    when = (log.began + timedelta(seconds=told.time)).astimezone()
    yield "time", f"{when:%Y-%m-%d %H:%M:%S}, {told.time:.1f} s after the log began"
    later = "" if told.was_told or told.stands is GONE else " (by its readings: it was not logged)"
    yield "why", (advised(told.stands) if told.stands else _moves(told)) + later
    if told.snapshot:
        time, snapshot = told.snapshot
        speed = snapshot.odometry.twist
        alarms = "".join(f", {alarm}" for alarm in snapshot.alarms)
        measured = f"{speed.v:z.2f} m/s, {degrees(speed.w):z.0f}°/s, {snapshot.battery.words}"
        yield "measured", f"{measured}{alarms}; {ago(time)}"
    if told.decision:
        time, made = told.decision
        began = told.mode_since if made.mode else None
        since = "" if began is None else f", for {max(0.0, told.time - began):.1f} s"
        yield "mode", f"{made.mode or 'none'}{since}"
        twist = made.decision.twist
        wanted = f"{twist.v:z.2f} m/s, {degrees(twist.w):z.0f}°/s" if told.parts else "nothing"
        yield "decided", f"{wanted}; {ago(time)}"
    for part in told.parts:
        took = f": takes {part.took}" if part.took else ""
        reason = f", {part.reason}" if part.reason else ""
        yield "", f"{part.action}: {part.wanted}{reason}{took}"
    if told.command:
        time, command = told.command
        yield "command", f"{_asked(command)}; {ago(time)}"
    if told.event:
        time, event = told.event
        yield "event", f"{event.kind}: {event.text}; {ago(time)}"


def _moves(told: "MomentTold") -> str:
    """Return the sentences about a robot that moves, as people were told them."""
    said = "; ".join(told.decision[1].told) if told.decision else ""
    return f"It moves{': ' if said else '.'}{said}"


def _asked(given: "CommandGiven") -> str:
    by = f"{given.by}: " if given.by else ""
    twist = given.twist
    speeds = "" if twist.is_zero else f" {twist.v:z.2f} m/s, {degrees(twist.w):z.0f}°/s"
    return f"{by}{given.command}{speeds}" + (f"; refused: {given.refused}" * bool(given.refused))
