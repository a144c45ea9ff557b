"""The wheel: one driver per robot. Taken, handed over, taken over; all the others watch.

Rules:

1. Who drives while the wheel is free has it, until a moment after letting go.
2. Who asks for it keeps it for as long as they are heard of, and while a mode they started runs;
   a mode that a page started ends with the page, and when the page falls silent.
3. Who takes it over stops the robot first; then it is theirs, and the one before is told.
4. Who goes, or gives it up, leaves a robot that stands.
"""

import asyncio
from collections.abc import Callable
from math import isfinite

from pioneer3.behaviors.action import Stack
from pioneer3.geometry import Twist2
from pioneer3.robot.pilot import STANDING
from pioneer3.runtime.robot import Robot
from pioneer3.teleop.lease import Lease
from pioneer3.web.guest import Somebody
from pioneer3.web.hands import Hands, Input

EXPIRY = 0.5
"""A page that falls silent drives this much longer [s]."""
KEPT = 5.0
"""Who has asked for the wheel and falls silent loses it after this [s]."""
STOPPING = 3.0
"""After a take-over, the robot is waited for no longer than this [s]."""


class Wheel:
    """Lets one at a time drive `robot`; `tell` passes news on to somebody."""

    def __init__(self, robot: Robot, tell: Callable[[Somebody, str], None]) -> None:
        self._robot = robot
        self._tell = tell
        self._hands = Hands(robot.arbiter)
        self._lease: Lease[Somebody] = Lease()
        self._keeper: Somebody | None = None
        self._mode: tuple[Somebody, Stack] | None = None
        self._heard_at = self._stopping_until = float("-inf")
        self._clock = asyncio.get_running_loop().time

    @property
    def holder(self) -> Somebody | None:
        """Who has the wheel, or `None`."""
        return self._starter() or self._lease.holder(self._clock())

    def driver(self) -> Somebody | str | None:
        """Return who drives, by name if it is nobody at the wheel; `None` for nobody."""
        name = self._robot.arbiter.driver
        if name in self._hands.names:
            return self.holder
        if self._mode and name in {ranked.action.name for ranked in self._mode[1].actions}:
            return self._starter()
        return name

    def drive(self, who: Somebody, twist: Twist2, source: Input = "touch") -> str | None:
        """Let `who` hold `twist` with `source`; return why the robot ignores it, or `None`.

        Zero lets go of that source.
        """
        if refused := self.take(who) or self._stopping():
            return refused
        if twist.is_zero:
            self._hands.release(source)
            return None
        return self._hands.hold(source, twist, EXPIRY)

    @property
    def ignored(self) -> str | None:
        """Why what was last held must be let go before it counts again, or `None`."""
        return self._hands.ignored

    def stop(self, who: Somebody) -> None:
        """Stop for `who`; what anybody else holds must be let go before it counts again.

        Another who has the wheel is told.
        """
        holder, why = self.holder, f"{who.name} stopped the robot"
        if holder is who:
            self._hands.stop(why)
            return
        self._robot.arbiter.stop(why=why)
        if holder is not None:
            self._tell(holder, f"{why}; to drive on, let go and press again")

    def start(
        self, who: Somebody, mode: Stack, seconds: float, *, patience: float = KEPT
    ) -> str | None:
        """Let `mode` drive for `who`, `seconds` at most; return why it does not, or `None`.

        It ends when `who` has not been :meth:`heard_of` for `patience` [s]; scripts, which are
        not, take `inf`.
        """
        if refused := self.take(who) or self._stopping():
            return refused
        self._hands.stop()
        self._mode = (who, mode)
        self._heard_at = self._clock()
        asyncio.get_running_loop().call_later(seconds, self._end, mode, "its time was over")
        refused = self._robot.arbiter.start(mode)
        if isfinite(patience):
            self._look_after(mode, patience)
        return refused

    def end_mode(self, who: Somebody) -> str | None:
        """End the mode; return why not, or `None`."""
        if refused := self.take(who):
            return refused
        self._robot.arbiter.end_mode(f"{who.name} ended it")
        return None

    def take(self, who: Somebody, *, keep: bool = False) -> str | None:
        """Give the wheel to `who` if it is free or theirs; return why not, or `None`."""
        holder = self.holder
        if holder is not None and holder is not who:
            return f"{holder.name} has the wheel"
        self._lease.take(who, self._clock(), KEPT if keep else None)
        if keep or holder is None:
            self._keeper = who if keep else None
        return None

    def heard_of(self, who: Somebody) -> None:
        """Note that `who` is still there."""
        if self._mode is not None and self._mode[0] is who:
            self._heard_at = self._clock()
        if self._keeper is who and self._lease.holder(self._clock()) is who:
            self._lease.take(who, self._clock(), KEPT)

    def take_over(self, who: Somebody) -> None:
        """Stop the robot, and give the wheel to `who`; who had it is told."""
        before = self.holder
        if before is not who:
            self._hands.stop(f"{who.name} took over")
            self._stopping_until = self._clock() + STOPPING
        self._pass_to(who)
        if before is not None and before is not who:
            self._tell(before, f"{who.name} took over; you watch now")

    def hand_over(self, who: Somebody, to: Somebody) -> str | None:
        """Stop the robot, and give the wheel of `who` to another; return why not, or `None`."""
        if self.holder is not who:
            return "you do not have the wheel"
        self._hands.stop()
        self._stopping_until = self._clock() + STOPPING
        self._pass_to(to)
        self._tell(to, f"{who.name} has handed you the wheel")
        return None

    def let_go(self, who: Somebody) -> None:
        """Take the wheel from `who`, who gives it up or is gone: the robot stops at once."""
        if self._starter() is who:
            self._robot.arbiter.end_mode(f"{who.name} let go")
        if self._lease.holder(self._clock()) is who:
            self._hands.let_go()
        self._lease.give_up(who)
        if self._keeper is who:
            self._keeper = None

    def _pass_to(self, who: Somebody) -> None:
        if holder := self._lease.holder(self._clock()):
            self._lease.give_up(holder)
        self._mode = None
        self.take(who, keep=True)

    def _starter(self) -> Somebody | None:
        """Return who started the mode that runs."""
        if self._mode is None or self._robot.arbiter.mode is not self._mode[1]:
            return None
        return self._mode[0]

    def _look_after(self, mode: Stack, patience: float) -> None:
        """End `mode` once who started it has fallen silent."""
        if self._mode is None or self._robot.arbiter.mode is not mode:
            return
        left = self._heard_at + patience - self._clock()
        if left > 0:
            asyncio.get_running_loop().call_later(left, self._look_after, mode, patience)
        else:
            self._end(mode, f"nothing was heard of {self._mode[0].name} for {patience:g} s")

    def _end(self, mode: Stack, why: str) -> None:
        if self._robot.arbiter.mode is mode:
            self._robot.arbiter.end_mode(why)

    def _stopping(self) -> str | None:
        """Return what to say while the robot still comes to a stand after a take-over."""
        snapshot = self._robot.snapshot
        if self._clock() >= self._stopping_until or snapshot is None:
            return None
        twist = snapshot.odometry.twist
        if abs(twist.v) < STANDING.v and abs(twist.w) < STANDING.w:
            self._stopping_until = float("-inf")
            return None
        return "the robot is still stopping"
