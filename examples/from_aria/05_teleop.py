"""Drive by the keys w, a, s, d and space, which stops; q ends. ARIA's teleopActionsExample.

ARIA: ArKeyHandler, addKeyHandler, ArFunctor, ArActionKeydrive, ArActionLimiterForwards. The command
`pioneer3 drive` has all of this and more, gamepads (ArActionJoydrive, ArJoyHandler) too.
"""

import sys
import termios
import tty
from collections.abc import Iterator
from contextlib import contextmanager

from pioneer3 import connect

TWISTS = {"w": (0.2, 0.0), "s": (-0.1, 0.0), "a": (0.0, 0.6), "d": (0.0, -0.6)}  # m/s, rad/s


@contextmanager
def single_keys() -> Iterator[None]:
    """Read keys as they are pressed."""
    if not sys.stdin.isatty():
        yield
        return
    before = termios.tcgetattr(sys.stdin)
    try:
        tty.setcbreak(sys.stdin)
        yield
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)


with single_keys(), connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    while (key := sys.stdin.read(1)) and key != "q":
        speed, turn_rate = TWISTS.get(key, (0.0, 0.0))
        room = robot.nearest(-0.5, 0.5).distance - robot.info.model.radius
        if speed > 0 and room < 0.35:
            speed = 0.0
            print(f"only {room:.2f} m ahead")
        robot.drive(speed, turn_rate)  # for half a second; a key that is held repeats
        print(f"{key!r}: {speed:.2f} m/s, {turn_rate:.2f} rad/s")
