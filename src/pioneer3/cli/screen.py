"""The monitor's screen: one view of everything a robot says, for 80 columns and 24 rows."""

from collections.abc import Sequence
from math import degrees, isfinite, isnan

from rich.console import Group, RenderableType
from rich.layout import Layout
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from pioneer3.models import SonarMount
from pioneer3.navigation.picture import CLOSE, NEAR
from pioneer3.robot.explain import Reason, advised
from pioneer3.robot.supervisor import Connection, ConnectionStatus, RobotInfo, is_simulator, kind
from pioneer3.state import LinkQuality, Snapshot, Sonar

FARTHEST = 5.0
"""A full bar [m]."""

WIDE = 100
"""From this many columns on the bars are long."""
SHORT_BAR, LONG_BAR = 8, 18
EIGHTHS = " ▏▎▍▌▋▊▉█"
FULL_RATE = 9.0
"""Reports in a second that a healthy link brings [1/s]."""


def screen(
    info: RobotInfo,
    snapshot: Snapshot | None,
    why: Reason | None,
    status: ConnectionStatus | None,
    *,
    width: int = 80,
    lasers: Sequence[Text] = (),
) -> RenderableType:
    """Return the whole screen, `width` columns wide, about the robot last connected.

    `snapshot` is `None` while the link is lost; `why` is the reason to stand still, if it does;
    `lasers` are lines about those at the computer.
    """
    layout = Layout()
    layout.split_column(
        Layout(_headline(info, status), size=1),
        Layout(name="middle"),
        Layout(_bottom(snapshot, why, status, lasers), size=5 + len(lasers)),
    )
    if snapshot is None:
        layout["middle"].update(Panel(Text("no readings: the link is lost", "bold red")))
        return layout
    sonar = _sonar(snapshot.sonar, info.model.sonars, LONG_BAR if width >= WIDE else SHORT_BAR)
    layout["middle"].split_row(
        Layout(Panel(_readings(snapshot), title="robot"), ratio=4),
        Layout(Panel(sonar, title="sonar, range in m"), ratio=5),
    )
    return layout


def line(snapshot: Snapshot) -> str:
    """Return the snapshot as one line of text."""
    readings = (f"{name} {text}" for name, text in snapshot.readings.items())
    words = [f"#{snapshot.sequence}", *readings, f"{snapshot.link.rate:.0f} reports/s"]
    return "  ".join([*words, *snapshot.alarms])


def _headline(info: RobotInfo, status: ConnectionStatus | None) -> Text:
    style = "black on cyan" if is_simulator(info) else "black on green"
    state = status.connection if status else Connection.CONNECTED
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append(f" {kind(info)} ", f"bold {style}")
    text.append(f" {info.identity.name}, {info.model.title}  ", "bold")
    text.append(f"{info.url}  ", "dim")
    text.append(state, "green" if state is Connection.CONNECTED else "bold red")
    return text


def _readings(snapshot: Snapshot) -> Table:
    odometry, motors = snapshot.odometry, snapshot.motors
    pose, twist = odometry.robot_in_odom, odometry.twist
    grid = Table.grid(padding=(0, 1))
    grid.add_column(style="dim", no_wrap=True)
    grid.add_column()
    grid.add_row("x", f"{pose.x:+z8.3f} m")
    grid.add_row("y", f"{pose.y:+z8.3f} m")
    grid.add_row("heading", f"{degrees(pose.theta):+z8.1f} deg")
    grid.add_row("speed", f"{twist.v:+z8.3f} m/s")
    grid.add_row("turn", f"{degrees(twist.w):+z8.1f} deg/s")
    grid.add_row("wheels", f"{odometry.left_speed:+z.3f} {odometry.right_speed:+z.3f} m/s")
    low = "bold yellow" if snapshot.battery.low else ""
    grid.add_row("battery", Text(snapshot.battery.words, low))
    moving = ", moving" if motors.moving else ""
    grid.add_row("motors", Text(f"on{moving}", "bold green") if motors.enabled else "off")
    grid.add_row("stop button", _alarm("PRESSED", "not pressed", up=motors.stop_button))
    grid.add_row("stall", _stall(snapshot))
    grid.add_row("bumps front", _bumpers(snapshot.bumpers.front))
    grid.add_row("bumps rear", _bumpers(snapshot.bumpers.rear))
    grid.add_row("inputs", f"{snapshot.inputs.digital_in:08b} {snapshot.inputs.analog:.2f} V")
    if snapshot.inputs.compass is not None:
        grid.add_row("compass", f"{degrees(snapshot.inputs.compass):+z.0f} deg")
    if snapshot.inputs.temperature is not None:
        grid.add_row("motor heat", f"{snapshot.inputs.temperature} °C")
    grid.add_row("faults", _alarm(", ".join(snapshot.faults), "none", up=bool(snapshot.faults)))
    return grid


def _alarm(loud: str, quiet: str, *, up: bool) -> Text:
    return Text(loud, "bold white on red") if up else Text(quiet)


def _stall(snapshot: Snapshot) -> Text:
    motors = snapshot.motors
    sides = {"LEFT": motors.left_stalled, "RIGHT": motors.right_stalled}
    return _alarm(" ".join(side for side, up in sides.items() if up), "none", up=motors.stalled)


def _bumpers(segments: Sequence[bool]) -> Text:
    text = Text() if segments else Text("none", "dim")
    for pressed in segments:
        text.append("■" if pressed else "□", "bold red" if pressed else "dim")
    return text


def _sonar(sonar: Sonar, mounts: Sequence[SonarMount], length: int) -> RenderableType:
    """Return a bar for each transducer; a ring of eight is a block, two blocks stand in a row."""
    if not sonar.ranges:
        return Text("no sonar", "dim")
    pairs = Table.grid(padding=(0, 1))
    for first in range(0, len(sonar.ranges), 16):
        pairs.add_row(_ring(sonar, mounts, first, length), _ring(sonar, mounts, first + 8, length))
    state = Text("pinging", "dim") if sonar.enabled else Text("switched off", "yellow")
    nearest = Text(f"\nnearest {_metres(sonar.nearest)} m, ").append_text(state)
    return Group(pairs, nearest)


def _ring(sonar: Sonar, mounts: Sequence[SonarMount], first: int, length: int) -> RenderableType:
    grid = Table.grid(padding=(0, 1))
    grid.add_column(justify="right", style="dim", no_wrap=True)
    grid.add_column(width=length, no_wrap=True)
    grid.add_column(justify="right", width=4, no_wrap=True)
    for number, metres in list(enumerate(sonar.ranges))[first : first + 8]:
        known = number < len(mounts)
        direction = f"{degrees(mounts[number].theta):+z4.0f}°" if known else f"{number}"
        grid.add_row(direction, bar(metres, length), _metres(metres))
    name = {0: "front", 8: "rear"}.get(first, f"from number {first}")
    return Group(Text(name, "bold"), grid) if grid.row_count else Text()


def bar(metres: float, length: int) -> Text:
    """Return a bar of up to `length` columns; full means that nothing is near."""
    if isnan(metres):
        return Text("?", "dim")
    steps = round(min(metres, FARTHEST) / FARTHEST * length * 8)
    whole, rest = divmod(steps, 8)
    drawn = ("█" * whole + EIGHTHS[rest].strip()).ljust(length)
    style = "red" if metres < NEAR else "yellow" if metres < CLOSE else "green"
    return Text(drawn, style if isfinite(metres) else "dim green")


def _metres(metres: float) -> str:
    return f"{metres:.2f}" if isfinite(metres) else "-"


def _bottom(
    snapshot: Snapshot | None,
    why: Reason | None,
    status: ConnectionStatus | None,
    lasers: Sequence[Text],
) -> Panel:
    lines = [*([_link(snapshot.link)] if snapshot else []), *lasers]
    if status and status.connection is not Connection.CONNECTED:
        lines.append(Text(f"{status.connection}: {status.message}", "bold red"))
    faulty = why is not None and why.wants_help
    lines.append(Text(advised(why) or "It moves.", "yellow" if faulty else ""))
    return Panel(Group(*lines), title="link and why it stands still", subtitle="Ctrl-C ends")


def _link(link: LinkQuality) -> Text:
    spoilt = link.bad_checksums or link.bytes_skipped
    slow = link.rate < FULL_RATE < link.reports  # in the first second it is not known yet
    text = Text(f"{link.rate:.0f} reports/s", "yellow" if slow else "")
    text.append(f", {link.reports} in session {link.sessions}, ", "")
    return text.append(
        f"{link.bad_checksums} bad checksums, {link.bytes_skipped} bytes lost",
        "yellow" if spoilt else "",
    )
