"""`pioneer3 laser`: a laser range finder alone, without a robot."""

import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import asdict
from math import degrees, inf, isfinite
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from pioneer3.cli.options import AUTO, UNITS, Distance, Flag, LaserOptions, Seconds
from pioneer3.cli.process import busy_sign, until_told_to_leave, write_json, write_line
from pioneer3.errors import DeviceError, LinkError

if TYPE_CHECKING:
    from rich.console import RenderableType

    from pioneer3.robot.lasers.driver import LaserDriver
    from pioneer3.state import Scan

laser_app = App(name="laser", help_epilogue=UNITS)

Where = Annotated[
    str, Parameter(name=["--port", "--laser"], env_var="PIONEER3_LASER", metavar="PORT")
]
Pose = Annotated[str, Parameter(metavar="POSE", allow_leading_hyphen=True)]
Mask = Annotated[str, Parameter(metavar="SECTORS", allow_leading_hyphen=True, show_default=False)]
PATIENCE = 9.0
"""For the first answer, and for the first scan [s]: longer than the driver's own."""
FIRST_REACH = 4.0


@laser_app.default
@until_told_to_leave
async def laser(
    port: Where = AUTO,
    *,
    laser_pose: Pose = "0,0,0",
    laser_mask: Mask = "",
    seconds: Seconds | None = None,
    json: Flag = False,
) -> int:
    """Show a laser: its identity, a picture of its scans, the closest reading.

    No robot is needed, and none moves. Without a terminal, a line for each second.

    Example: pioneer3 laser /dev/ttyACM0
    Example: pioneer3 laser tcp://192.168.0.10:10940 --json

    Args:
        port: [MODEL@]PORT, such as /dev/ttyACM0, tcp://192.168.0.10:10940, lms-200@/dev/ttyUSB1;
            auto looks at the serial ports of this computer.
        laser_pose: x,y,heading[,upside-down] on the robot, such as 160mm,0,0.
        laser_mask: Sectors to leave out, such as -135:-120,120:135.
        seconds: End after this time.
        json: One JSON object for each scan, a line each; the first line is the identity.
    """
    options = LaserOptions(
        laser=(port,), laser_pose=(laser_pose,), laser_mask=(laser_mask,) if laser_mask else ()
    )
    length = inf if seconds is None else seconds
    async with _driver(options) as driver:
        if json:
            return await _write(driver, length)
        if sys.stdout.isatty():
            return await _show(driver, length)
        return await _tell(driver, length)


@laser_app.command
@until_told_to_leave
async def mask(
    port: Where = AUTO,
    *,
    seconds: Seconds = 5.0,
    nearer_than: Distance = 0.3,
    laser_pose: Pose = "0,0,0",
) -> int:
    """Learn the sectors in which the laser sees the robot's own posts.

    Clear the floor around the robot, then start this: directions in which something
    is near in every scan become sectors to leave out. It prints them as an option
    and as a line for the file of the robot.

    Example: pioneer3 laser mask /dev/ttyACM0

    Args:
        port: As for `pioneer3 laser`.
        seconds: How long to look.
        nearer_than: Things nearer to the laser than this belong to the robot.
        laser_pose: As for `pioneer3 laser`; it matters for a laser that hangs upside-down.
    """
    from pioneer3.robot.lasers.mounting import learned, words

    options = LaserOptions(laser=(port,), laser_pose=(laser_pose,))
    async with _driver(options) as driver:
        with busy_sign(f"Looking for {seconds:g} s; stay away from the robot ..."):
            scans = [scan async for scan in _scans(driver, seconds) if scan is not None]
    sectors = learned(scans, nearer_than)
    if not sectors:
        write_line(f"Nothing is nearer than {nearer_than:g} m in every scan: no mask is needed.")
        return 0
    for line in words(sectors):
        write_line(line)
    return 0


@laser_app.command(name="id")
@until_told_to_leave
async def identify(port: Where = AUTO) -> int:
    """Print the serial number of a laser, nothing else; rules of udev ask so.

    Example: pioneer3 laser id /dev/ttyACM0

    Args:
        port: As for `pioneer3 laser`.
    """
    async with _driver(LaserOptions(laser=(port,))) as driver:
        serial = (await driver.identified()).serial
        write_line(serial or "unknown")
    return 0 if serial else 1


@asynccontextmanager
async def _driver(options: LaserOptions) -> "AsyncIterator[LaserDriver]":
    """Run the driver of the laser during the block; wait until it is identified before.

    Raises:
        LinkError: no laser answers; the message has the reason.
    """
    from pioneer3.robot.lasers.driver import LaserDriver
    from pioneer3.tasks import running

    asked = ", ".join(options.laser)
    with busy_sign(f"Looking for a laser at {asked} ..."):
        (spec,) = await options.specs()
    driver = LaserDriver(spec.config(), mounting=lambda: spec.mounting_on(None))
    async with running(driver.run()):
        with busy_sign(f"Connecting to {spec.url} ..."):
            await _identified(driver)
        yield driver


async def _identified(driver: "LaserDriver") -> None:
    """Wait until the laser has said what it is; LinkError, with the reason, if it cannot."""
    import asyncio

    from pioneer3.robot.supervisor import Connection

    async def failed() -> str:
        async for status in driver.status.values():
            if status.connection in {Connection.LOST, Connection.CLOSED}:
                return status.message
        return "closed"

    told, reason = asyncio.create_task(driver.identified(PATIENCE)), asyncio.create_task(failed())
    try:
        await asyncio.wait((told, reason), return_when=asyncio.FIRST_COMPLETED)
        if driver.identity is None and reason.done():
            raise LinkError(reason.result())
        await told
    except DeviceError as error:
        raise LinkError(str(error)) from None
    finally:
        told.cancel()
        reason.cancel()


async def _write(driver: "LaserDriver", seconds: float) -> int:
    await driver.reading(PATIENCE)
    write_json({"url": driver.config.url, "identity": driver.identity})
    async for scan in _scans(driver, seconds):
        write_json({"scan": scan, "closest": _closest(scan) if scan else None})
    return _code(driver)


async def _tell(driver: "LaserDriver", seconds: float) -> int:
    import asyncio

    for line in identity_lines(driver):
        write_line(line)
    clock = asyncio.get_running_loop().time
    due = clock()
    async for scan in _scans(driver, seconds):
        if scan is None or clock() >= due:
            due = clock() + 1.0
            write_line(reading_line(driver, scan))
    return _code(driver)


async def _show(driver: "LaserDriver", seconds: float) -> int:
    from rich.live import Live

    from pioneer3.cli.terminal import Terminal
    from pioneer3.demo.drawing import reach_for_points
    from pioneer3.demo.modes.sensors import points_in_robot

    console = Terminal()
    reach = FIRST_REACH
    with Live(console=console, screen=True, auto_refresh=False) as live:
        async for scan in _scans(driver, seconds, pace=0.1):
            if scan is not None:
                reach = reach_for_points(points_in_robot(scan), reach)
            live.update(view(driver, scan, console.width, console.height, reach), refresh=True)
    return _code(driver)


async def _scans(
    driver: "LaserDriver", seconds: float, pace: float = 0.0
) -> "AsyncIterator[Scan | None]":
    """Yield each scan for `seconds`, at most one in `pace` [s]; `None` twice a second if lost."""
    import asyncio

    clock = asyncio.get_running_loop().time
    end, values = clock() + seconds, driver.values()
    while (left := end - clock()) > 0:
        try:
            async with asyncio.timeout(min(left, 0.5)):
                scan = await anext(values)
        except TimeoutError:
            values = driver.values()
            if not driver.connected:
                yield None
        except StopAsyncIteration:
            return
        else:
            yield scan
            if pace:
                await asyncio.sleep(min(pace, max(0.0, end - clock())))


def _code(driver: "LaserDriver") -> int:
    return 0 if driver.connected else 1


def identity_lines(driver: "LaserDriver") -> list[str]:
    """Return the identity of the laser, a line for each part."""
    identity = asdict(driver.identity) if driver.identity else {}
    told = [f"{name.replace('_', ' '):14}{value}" for name, value in identity.items() if value]
    return [f"laser at {driver.config.url}", *told]


def reading_line(driver: "LaserDriver", scan: "Scan | None") -> str:
    """Return the closest and the farthest reading and the rate; or why nothing comes."""
    if scan is None:
        return f"{'LOST' if driver.scans else 'No scan yet'}: {driver.presence}"
    valid = _valid(scan)
    seen = (
        f"closest {_polar(min(valid))}, farthest {_polar(max(valid))}"
        if valid
        else "nothing in range"
    )
    return f"{seen}, {len(scan.ranges)} readings, {driver.rate:.0f} scans/s"


def _polar(reading: tuple[float, float]) -> str:
    metres, angle = reading
    return f"{metres:.2f} m at {degrees(angle):z.0f}°"


def _closest(scan: "Scan") -> dict[str, float] | None:
    metres, angle = min(_valid(scan), default=(None, None))
    return None if metres is None or angle is None else {"range": metres, "angle": angle}


def _valid(scan: "Scan") -> list[tuple[float, float]]:
    """Return range [m] and direction [rad] of each valid reading."""
    readings = zip(scan.ranges, scan.angles, strict=True)
    return [(metres, angle) for metres, angle in readings if isfinite(metres)]


def view(
    driver: "LaserDriver", scan: "Scan | None", columns: int, rows: int, reach: float
) -> "RenderableType":
    """Return the screen of `columns` by `rows`: title, picture, closest reading, hint.

    The edge of the picture is `reach` [m] away.
    """
    from rich.console import Group
    from rich.text import Text

    from pioneer3.demo.drawing import around_laser
    from pioneer3.demo.modes.sensors import points_in_robot

    title = Text(f"{driver.title}", "bold", no_wrap=True, overflow="ellipsis")
    line = reading_line(driver, scan)
    told = Text(line, "bold red" if scan is None else "bold", no_wrap=True, overflow="ellipsis")
    hint = Text("straight ahead is up; Ctrl-C ends", "dim")
    shown = scan or driver.latest
    if shown is None or rows < 6:
        return Group(title, told, hint)
    drawn = around_laser(points_in_robot(shown), columns, rows - 4, reach).text()
    drawn.end = "\n"
    return Group(title, drawn, told, hint)
