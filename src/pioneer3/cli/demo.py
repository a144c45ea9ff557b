"""`pioneer3 demo`."""

import sys
from functools import partial

from pioneer3.cli.options import LINK, Flag, LinkOptions, MaxSpeed, Patience
from pioneer3.cli.process import until_told_to_leave, write_line
from pioneer3.errors import ConfigError


@until_told_to_leave
async def demo(
    *,
    link: LinkOptions = LINK,
    mode: str = "t",
    patience: Patience = 10.0,
    max_speed: MaxSpeed | None = None,
    acts: str = "tcp://127.0.0.1:5001",
    plain: Flag = False,
) -> int:
    """Try everything that a robot can do: the lab's robotDemo on a full screen.

    A letter chooses a mode, h shows the keys, space stops, k is the emergency stop,
    escape quits. It begins in teleop with the motors on, as ARIA's demo does;
    nothing moves before a key.

    Example: pioneer3 demo --port /dev/ttyUSB0

    Args:
        mode: Letter of the mode to begin with.
        patience: A speed set by hand ends after so long without a key; 10 at most.
        acts: The colour tracker of the acts mode.
        plain: Print ARIA's lines, for pipes and screen readers; keys come from standard input.
    """
    from pioneer3.demo.modes import MODES
    from pioneer3.demo.start import start_plain, start_screen
    from pioneer3.robot.devices import Acts

    keys = [one.key for one in MODES]
    if mode.lower() not in keys:
        raise ConfigError(f"--mode {mode}: it must be one of {' '.join(keys)}")
    if not plain and not all(one is not None and one.isatty() for one in (sys.stdin, sys.stdout)):
        raise ConfigError("the demo's screen needs a terminal; --plain does without one")
    async with link.connect(max_speed=max_speed, shown=True) as robot:
        start = partial(start_plain, write=write_line) if plain else start_screen
        return await start(robot, first=mode.lower(), patience=patience, acts=Acts(acts))
