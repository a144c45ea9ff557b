"""`pioneer3 demo`."""

import sys
from typing import Annotated, TextIO

from cyclopts import Parameter
from cyclopts.validators import Number

from pioneer3.cli.flags import Flag
from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.options import DEFAULT_PORT, Baud, Port

KEYS = "tuwlbspcdofimag"


def demo(
    *,
    port: Port = DEFAULT_PORT,
    baud: Baud = None,
    mode: str = "t",
    patience: Annotated[float, Parameter(validator=Number(gt=0))] = 10.0,
    acts: str = "tcp://127.0.0.1:5001",
    plain: Flag = False,
) -> int:
    """Try everything that a robot can do: the lab's robotDemo on a full screen.

    A letter chooses a mode, h shows the keys, k is the emergency stop, escape quits.
    It begins in teleop with the motors on, as ARIA's demo does; nothing moves before a key.

    Example: pioneer3 demo --port /dev/ttyUSB0

    Args:
        port: The robot: /dev/ttyUSB0, tcp://localhost:8101.
        baud: Serial speed to try first.
        mode: Letter of the mode to begin with.
        patience: A speed set by hand ends after so long without a key [s]; inf never.
        acts: The colour tracker of the acts mode.
        plain: Print ARIA's lines, for pipes and screen readers; keys come from standard input.
    """
    return run_until_told_to_leave(_demo(port, baud, mode, patience, acts, plain=plain))


async def _demo(
    port: str, baud: int | None, mode: str, patience: float, acts: str, *, plain: bool
) -> int:
    from contextlib import AsyncExitStack  # noqa: PLC0415

    from pioneer3.cli.output import busy_sign  # noqa: PLC0415
    from pioneer3.demo.start import start_plain, start_screen  # noqa: PLC0415
    from pioneer3.errors import ConfigError  # noqa: PLC0415
    from pioneer3.runtime.connect import connect_async  # noqa: PLC0415
    from pioneer3.runtime.devices import Acts  # noqa: PLC0415

    if len(mode) != 1 or mode.lower() not in KEYS:
        raise ConfigError(f"--mode {mode}: it must be one of {' '.join(KEYS)}")
    if not plain and not (_is_terminal(sys.stdin) and _is_terminal(sys.stdout)):
        raise ConfigError("the demo's screen needs a terminal; --plain does without one")
    async with AsyncExitStack() as stack:
        with busy_sign(f"Connecting to {port} ..."):
            robot = await stack.enter_async_context(connect_async(port, baud=baud))
        start = start_plain if plain else start_screen
        return await start(robot, first=mode.lower(), patience=patience, acts=Acts(acts))


def _is_terminal(stream: TextIO | None) -> bool:
    return stream is not None and stream.isatty()
