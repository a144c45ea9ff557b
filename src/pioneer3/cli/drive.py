"""`pioneer3 drive`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.options import DEFAULT_PORT, Baud, Port

if TYPE_CHECKING:
    from pioneer3.geometry import Twist2

KEYS = (
    "arrows or w a s d: drive   space: stop   + -: faster, slower   "
    "m: motors   e: emergency stop, again: release   q: quit"
)


GAMEPAD = (
    "hold L1: drive with the left stick   R1 as well: faster   B or circle: stop   "
    "Back or Share: emergency stop   Start or Options: release it   Ctrl-C: quit"
)
SPEED, TURN_RATE = 0.5, 0.5
"""Of the keys [m/s, rad/s]."""


def drive(
    *,
    port: Port = DEFAULT_PORT,
    baud: Baud = None,
    speed: float | None = None,
    turn_rate: float | None = None,
    gamepad: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    latch: bool = False,
    record: Path | None = None,
) -> int:
    """Drive with the keyboard of this terminal: arrows drive, space stops, q quits.

    A terminal does not tell when a key is let go: a key acts for 0.6 s, and its repeats extend
    that. Alternate two keys to drive a curve. With --gamepad no terminal is needed.

    Example: pioneer3 drive --port /dev/ttyUSB0 --speed 0.3

    Args:
        port: The robot: /dev/ttyUSB0, tcp://localhost:8101.
        baud: Serial speed to try first.
        speed: Of the forward key [m/s], 0.5 if not said; + and - change it. Of a gamepad's stick,
            0.4, and 2.5 times that with turbo.
        turn_rate: Of the turning keys [rad/s], 0.5 if not said; + and - change it. Of a gamepad's
            stick, 0.6, and twice that with turbo.
        gamepad: Drive with a gamepad of this machine instead: the first, or one by a part of its
            name, or by its path, such as /dev/input/event5.
        latch: One press keeps moving until another key, as in the lab's rob_key.
        record: New file for every byte on the wire; --port replay:FILE plays it.
    """
    if gamepad is None:
        drives = _drive(port, baud, speed, turn_rate, latch=latch, record=record)
    else:
        drives = _drive_gamepad(port, baud, speed, turn_rate, " ".join(gamepad), record=record)
    return run_until_told_to_leave(drives)


async def _drive(
    port: str,
    baud: int | None,
    speed: float | None,
    turn_rate: float | None,
    *,
    latch: bool,
    record: Path | None,
) -> int:
    from pioneer3.cli.live import announce, rewrite  # noqa: PLC0415
    from pioneer3.runtime.connect import connect_async  # noqa: PLC0415
    from pioneer3.teleop.drive import KeyboardDriver  # noqa: PLC0415
    from pioneer3.teleop.keyboard import Keyboard  # noqa: PLC0415
    from pioneer3.teleop.terminal import keys, raw_terminal  # noqa: PLC0415

    wanted = _positive(speed, turn_rate)
    with raw_terminal() as terminal:
        async with connect_async(port, baud=baud, record=record) as robot:
            keyboard = Keyboard.within(robot.info.limits, wanted.v, wanted.w, latch=latch)
            announce(robot, "waits for keys")
            print(KEYS)  # noqa: T201
            await KeyboardDriver(robot, keyboard, rewrite).run(keys(terminal))
    return 0


async def _drive_gamepad(
    port: str,
    baud: int | None,
    speed: float | None,
    turn_rate: float | None,
    name: str,
    *,
    record: Path | None,
) -> int:
    import sys  # noqa: PLC0415
    from functools import partial  # noqa: PLC0415

    from pioneer3.cli.live import announce, show_while  # noqa: PLC0415
    from pioneer3.cli.output import write_line  # noqa: PLC0415
    from pioneer3.runtime.connect import connect_async  # noqa: PLC0415
    from pioneer3.teleop.evdev import open_gamepad, read  # noqa: PLC0415
    from pioneer3.teleop.gamepad import SCHEME  # noqa: PLC0415
    from pioneer3.teleop.gamepad_drive import GamepadDriver  # noqa: PLC0415

    def tell(news: str) -> None:
        write_line(f"\r\x1b[K{news}" if sys.stdout.isatty() else news)

    _positive(speed, turn_rate)
    with open_gamepad(name):
        pass  # what is wrong with it is said before anything moves
    async with connect_async(port, baud=baud, record=record) as robot:
        announce(robot, "waits for the gamepad")
        write_line(GAMEPAD)
        scheme = SCHEME.at(speed, turn_rate)
        driver = GamepadDriver(robot, partial(open_gamepad, name), read, tell, scheme)
        await show_while(robot, driver.run())
    return 0


def _positive(speed: float | None, turn_rate: float | None) -> "Twist2":
    """Return the speeds of the keys.

    Raises:
        CommandError: they are not positive numbers.
    """
    from pioneer3.errors import CommandError  # noqa: PLC0415
    from pioneer3.robot.limits import checked  # noqa: PLC0415

    wanted = checked(
        SPEED if speed is None else speed, TURN_RATE if turn_rate is None else turn_rate
    )
    if wanted.v <= 0 or wanted.w <= 0:
        raise CommandError("--speed and --turn-rate must be positive")
    return wanted
