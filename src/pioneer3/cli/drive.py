"""`pioneer3 drive`."""

from pathlib import Path

from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.options import DEFAULT_PORT, Baud, Port

KEYS = (
    "arrows or w a s d: drive   space: stop   + -: faster, slower   "
    "m: motors   e: emergency stop, again: release   q: quit"
)


def drive(
    *,
    port: Port = DEFAULT_PORT,
    baud: Baud = None,
    speed: float = 0.5,
    turn_rate: float = 0.5,
    latch: bool = False,
    record: Path | None = None,
) -> int:
    """Drive with the keyboard of this terminal: arrows drive, space stops, q quits.

    A terminal does not tell when a key is let go: a key acts for 0.6 s, and its repeats extend
    that. Alternate two keys to drive a curve.

    Example: pioneer3 drive --port /dev/ttyUSB0 --speed 0.3

    Args:
        port: The robot: /dev/ttyUSB0, tcp://localhost:8101.
        baud: Serial speed to try first.
        speed: Of the forward key [m/s]; + and - change it.
        turn_rate: Of the turning keys [rad/s]; + and - change it.
        latch: One press keeps moving until another key, as in the lab's rob_key.
        record: New file for every byte on the wire; --port replay:FILE plays it.
    """
    return run_until_told_to_leave(_drive(port, baud, speed, turn_rate, latch=latch, record=record))


async def _drive(
    port: str,
    baud: int | None,
    speed: float,
    turn_rate: float,
    *,
    latch: bool,
    record: Path | None,
) -> int:
    from pioneer3.cli.live import announce, rewrite  # noqa: PLC0415
    from pioneer3.errors import CommandError  # noqa: PLC0415
    from pioneer3.robot.limits import checked  # noqa: PLC0415
    from pioneer3.runtime.connect import connect_async  # noqa: PLC0415
    from pioneer3.teleop.drive import KeyboardDriver  # noqa: PLC0415
    from pioneer3.teleop.keyboard import Keyboard  # noqa: PLC0415
    from pioneer3.teleop.terminal import keys, raw_terminal  # noqa: PLC0415

    wanted = checked(speed, turn_rate)
    if wanted.v <= 0 or wanted.w <= 0:
        raise CommandError("--speed and --turn-rate must be positive")
    with raw_terminal() as terminal:
        async with connect_async(port, baud=baud, record=record) as robot:
            limits = robot.info.limits
            keyboard = Keyboard(
                speed=min(wanted.v, limits.max_speed),
                turn_rate=min(wanted.w, limits.max_turn_rate),
                latch=latch,
                max_speed=limits.max_speed,
                max_turn_rate=limits.max_turn_rate,
            )
            announce(robot, "waits for keys")
            print(KEYS)  # noqa: T201
            await KeyboardDriver(robot, keyboard, rewrite).run(keys(terminal))
    return 0
