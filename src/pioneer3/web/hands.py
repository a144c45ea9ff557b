"""What the hands at the wheel hold: a gamepad before the keys, the keys before a touch.

One of them drives. What comes second has to be let go and held anew before it counts: nothing
drives again by itself because something else was let go.
"""

import asyncio
from typing import Literal

from pioneer3.behaviors.actions import Hold
from pioneer3.geometry import Twist2
from pioneer3.robot.pilot import STOPPED
from pioneer3.runtime.arbiter import Arbiter
from pioneer3.runtime.priorities import GAMEPAD, KEYBOARD, WEB

Input = Literal["gamepad", "keyboard", "touch", "tilt"]
"""What somebody drives with; scripts count as touch."""
RANKS: dict[Input, tuple[str, int]] = {
    "gamepad": ("web gamepad", GAMEPAD),
    "keyboard": ("web keyboard", KEYBOARD),
    "touch": ("web", WEB),
    "tilt": ("web", WEB),
}
"""Name and priority of the hold of each input."""


class Hands:
    """The holds of one wheel, at the arbiter of its robot."""

    def __init__(self, arbiter: Arbiter) -> None:
        self._arbiter = arbiter
        self._clock = asyncio.get_running_loop().time
        self._holds: dict[int, Hold] = {}
        for name, priority in dict(RANKS.values()).items():
            self._holds[priority] = Hold(name, streams=True)
            arbiter.add(self._holds[priority], priority)
        self._last = self._holds[WEB]

    @property
    def names(self) -> frozenset[str]:
        """What decisions call them."""
        return frozenset(hold.name for hold in self._holds.values())

    @property
    def ignored(self) -> str | None:
        """Why what was last held must be let go before it counts again, or `None`."""
        return self._last.ignored(self._arbiter.last_stop)

    def hold(self, source: Input, twist: Twist2, seconds: float) -> str | None:
        """Hold `twist` with `source` for `seconds`; return why the robot ignores it, or `None`."""
        rank, now, last = RANKS[source][1], self._clock(), self._arbiter.last_stop
        mine = self._last = self._holds[rank]
        first = next((o for r, o in self._holds.items() if r > rank and o.holds(now, last)), None)
        if first is not None:
            mine.set(twist, now, seconds, last)
            mine.overrule(f"the {first.name} drives", now)
            return mine.ignored(last)
        for lower in (hold for r, hold in self._holds.items() if r < rank):
            lower.overrule(f"the {mine.name} drives", now)
        return self._arbiter.hold(mine, twist, seconds)

    def release(self, source: Input) -> None:
        """Let go with `source`; the robot stops if nobody else drives."""
        self._last = self._holds[RANKS[source][1]]
        self._arbiter.release(self._last)

    def let_go(self) -> None:
        """Let go of everything; the robot stops if nobody else drives."""
        for hold in self._holds.values():
            hold.release()
        self._arbiter.decide()

    def stop(self, why: str = STOPPED) -> None:
        """Let go of everything and stop, which ends a mode because of `why`.

        What others hold must be let go before it counts again.
        """
        for hold in self._holds.values():
            hold.release()
        self._arbiter.stop(why=why)
