"""Control of a robot from pages and scripts: who may drive it, and with which input.

Rules:

1. One operator at a time has control of a robot, by a lease. The others watch.
2. Driving a robot that nobody controls takes control, until a moment after letting go.
3. An operator who asks for control keeps it while the client is alive and while a mode runs that
   the operator started. A mode that a page started ends with the page, and when the page has been
   silent for a moment. It does not begin for one who left, let go or fell silent meanwhile.
4. A take-over stops the robot first. Then the new operator has control, and the old one is told.
5. The robot stops when its operator leaves or releases control.
6. Of an operator's inputs a gamepad comes before the keyboard, and the keyboard before a touch.
   One of them drives. The other has to be let go and held anew before it counts: no input drives
   again by itself because another one was let go.

Whether a command counts after a stop is decided in :mod:`pioneer3.stops`.
"""

import asyncio
from collections.abc import Callable
from math import isfinite
from typing import Generic, Protocol, TypeVar

from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import Hold
from pioneer3.behaviors.modes import Goto, Mode
from pioneer3.errors import Refusal
from pioneer3.geometry import Pose2, Twist2
from pioneer3.robot.pilot import STOPPED, stands
from pioneer3.runtime.arbiter import GAMEPAD, KEYBOARD, WEB, Arbiter
from pioneer3.runtime.robot import Robot
from pioneer3.web import requests
from pioneer3.web.requests import Input
from pioneer3.web.scene import RobotScene

T = TypeVar("T")

TERM = 1.0
"""A lease lasts this long after its holder let go [s]."""
EXPIRY = 0.5
"""Time that a velocity from a page lasts without renewal [s]."""
KEPT = 5.0
"""An operator who asked for control and falls silent loses it after this [s]."""
SILENCE = 2.0
"""A mode ends when nothing was heard for this long of the page that started it [s].

Pages ping twice a second, from the thread that carries out a press on stop.
"""
STOPPING = 3.0
"""After a take-over, commands wait for the robot to stand no longer than this [s]."""
GOTO_TIME = 600.0
"""Time limit of a drive to a place [s]."""
INPUTS: dict[Input, tuple[str, int]] = {
    "gamepad": ("web gamepad", GAMEPAD),
    "keyboard": ("web keyboard", KEYBOARD),
    "touch": ("web", WEB),
    "tilt": ("web", WEB),
}
"""Name and priority of the hold of each input; scripts count as touch."""


class Operator(Protocol):
    """A person or a script that can have control. Operators are compared by identity."""

    @property
    def name(self) -> str:
        """Shown to all."""


class ControlRule(Protocol):
    """Decides whether an operator may drive a robot now, besides control."""

    def __call__(self, operator: Operator, *, take_over: bool) -> Refusal | None:
        """Return the refusal of driving, or of taking control over; `None` if it is allowed."""


def no_rule(operator: Operator, *, take_over: bool) -> None:
    """Allow everything."""


class Lease(Generic[T]):
    """A right that one holder has at a time; it ends unless it is renewed."""

    def __init__(self) -> None:
        self._holder: T | None = None
        self._until = float("-inf")

    def take(self, holder: T, now: float, term: float = TERM) -> bool:
        """Take or renew the lease at `now` [s, monotonic]; return whether `holder` has it.

        It lasts for `term` [s], or longer if it did already.
        """
        before = self.holder(now)
        if before is not None and before != holder:
            return False
        self._until = max(self._until, now + term) if before == holder else now + term
        self._holder = holder
        return True

    def holder(self, now: float) -> T | None:
        """Return the holder, or `None`."""
        return self._holder if now < self._until else None

    def release(self, holder: T) -> None:
        """End the lease of `holder`; nothing happens if another has it."""
        if self._holder == holder:
            self._holder, self._until = None, float("-inf")


class OperatorInputs:
    """The inputs of one operator, each a hold at the arbiter of the robot."""

    def __init__(self, arbiter: Arbiter) -> None:
        self._arbiter = arbiter
        self._clock = asyncio.get_running_loop().time
        self._holds: dict[int, Hold] = {}
        for name, priority in dict(INPUTS.values()).items():
            self._holds[priority] = Hold(name, streams=True)
            arbiter.add(self._holds[priority], priority)
        self._last = self._holds[WEB]

    @property
    def names(self) -> frozenset[str]:
        """Names of the holds in decisions."""
        return frozenset(hold.name for hold in self._holds.values())

    @property
    def ignored(self) -> Refusal | None:
        """The refusal of the last input until it is let go of, or `None`."""
        return self._last.ignored(self._arbiter.last_stop)

    def hold(self, source: Input, twist: Twist2, seconds: float) -> Refusal | None:
        """Hold `twist` for `seconds`."""
        priority, now, last = INPUTS[source][1], self._clock(), self._arbiter.last_stop
        mine = self._last = self._holds[priority]
        higher = [hold for p, hold in self._holds.items() if p > priority and hold.holds(now, last)]
        if higher:
            mine.set(twist, now, seconds, last)
            mine.overrule(f"the {higher[0].name} drives", now)
            return mine.ignored(last)
        for lower in (hold for p, hold in self._holds.items() if p < priority):
            lower.overrule(f"the {mine.name} drives", now)
        return self._arbiter.hold(mine, twist, seconds)

    def release(self, source: Input) -> None:
        """Let go of one input; the robot stops if no other drives."""
        self._last = self._holds[INPUTS[source][1]]
        self._arbiter.release(self._last)

    def forget(self) -> None:
        """Let go of every input, before the arbiter decides anew."""
        for hold in self._holds.values():
            hold.release()

    def release_all(self) -> None:
        """Let go of every input; the robot stops if nothing else drives."""
        self.forget()
        self._arbiter.decide()

    def stop(self, why: str = STOPPED) -> None:
        """Release every input and stop the robot. A mode ends with the reason `why`.

        Commands that others hold must be let go before they count again.
        """
        self.forget()
        self._arbiter.stop(why=why)


class Control:
    """Lets one operator at a time drive `robot`, if `rule` does not refuse it.

    `tell` passes news on to an operator.
    """

    def __init__(
        self,
        robot: Robot,
        scene: RobotScene,
        tell: Callable[[Operator, str], None],
        rule: ControlRule = no_rule,
    ) -> None:
        self._robot = robot
        self._scene = scene
        self._tell = tell
        self._rule = rule
        self._inputs = OperatorInputs(robot.arbiter)
        self._lease: Lease[Operator] = Lease()
        self._keeper: Operator | None = None
        self._mode: tuple[Operator, Stack] | None = None
        self._heard_at: dict[Operator, float] = {}
        self._stopping_until = float("-inf")
        self._clock = asyncio.get_running_loop().time

    @property
    def holder(self) -> Operator | None:
        """The operator who has control, or `None`."""
        return self._starter() or self._lease.holder(self._clock())

    def who_drives(self) -> Operator | str | None:
        """Return the operator who drives, or the name of another driving action, or `None`."""
        name = self._robot.arbiter.driving_action
        if name in self._inputs.names:
            return self.holder
        if self._mode and name in {ranked.action.name for ranked in self._mode[1].actions}:
            return self._starter()
        return name

    def drive(self, operator: Operator, twist: Twist2, source: Input = "touch") -> Refusal | None:
        """Hold `twist` with an input; zero lets go of it."""
        if refused := self.take(operator) or self._stopping():
            return refused
        if twist.is_zero:
            self._inputs.release(source)
            return None
        return self._inputs.hold(source, twist, EXPIRY)

    def drive_from_page(
        self, operator: Operator, twist: Twist2, source: Input = "touch"
    ) -> Refusal | None:
        """Drive; return the refusal of an operator who must let go first, or has no control.

        Snapshots tell all other reasons.
        """
        refused = self.drive(operator, twist, source)
        return refused if self._inputs.ignored or self.holder is not operator else None

    def stop(self, operator: Operator) -> None:
        """Stop for `operator`; commands of others must be let go before they count again.

        Another operator who has control is told.
        """
        holder, why = self.holder, f"{operator.name} stopped the robot"
        if holder is operator:
            self._inputs.stop(why)
            return
        self._robot.arbiter.stop(why=why)
        if holder is not None:
            self._tell(holder, f"{why}; to drive on, let go and press again")

    def start_mode(
        self, operator: Operator, mode: Mode, *, patience: float = SILENCE
    ) -> Refusal | None:
        """Start a mode of the page or the API as :meth:`start` does."""
        if self._robot.snapshot is None:
            return Refusal("the robot is not connected")
        return self.start(
            operator, mode.stack(self._robot.info.limits), mode.seconds, patience=patience
        )

    def start(
        self, operator: Operator, mode: Stack, seconds: float, *, patience: float = SILENCE
    ) -> Refusal | None:
        """Let `mode` drive for `seconds` at most.

        It ends when :meth:`keep_alive` was not called for `operator` during `patience` [s], and
        does not begin after that. Scripts, for which nothing calls it, pass `inf`.
        """
        if self._silence(operator) > patience:
            return Refusal(_nothing_heard(operator, patience))
        if refused := self.take(operator) or self._stopping():
            return refused
        self._inputs.forget()
        self._mode = (operator, mode)
        asyncio.get_running_loop().call_later(seconds, self._end, mode, "its time was over")
        refused = self._robot.arbiter.start(mode)
        if isfinite(patience):
            self._watch_silence(operator, mode, patience)
        return refused

    def goto(self, operator: Operator, request: requests.GotoPlace) -> Refusal | None:
        """Drive straight to a place, where there is no map.

        The operator must stay connected.
        """
        snapshot = self._robot.snapshot
        if snapshot is None:
            return Refusal("The robot is not connected.")
        odom = snapshot.odometry.robot_in_odom
        place = Pose2(request.x, request.y, request.heading or 0.0)
        goal = self._scene.odom_in_map_now(odom).inverse() @ place
        heading = None if request.heading is None else goal.theta
        mode = Goto(x=goal.x, y=goal.y, heading=heading, speed=request.speed, seconds=GOTO_TIME)
        return self.start_mode(operator, mode)

    def end_mode(self, operator: Operator) -> Refusal | None:
        """End the mode."""
        if refused := self.take(operator):
            return refused
        self._robot.arbiter.end_mode(f"{operator.name} ended it")
        return None

    def take(self, operator: Operator, *, keep: bool = False) -> Refusal | None:
        """Give control to `operator` if it is free or theirs.

        With `keep` it stays with the operator while the client is alive.
        """
        if refused := self._rule(operator, take_over=False):
            return refused
        holder = self.holder
        if holder is not None and holder is not operator:
            return Refusal(f"{holder.name} has control")
        self._lease.take(operator, self._clock(), KEPT if keep else TERM)
        if keep or holder is None:
            self._keeper = operator if keep else None
        return None

    def keep_alive(self, operator: Operator) -> None:
        """Note that the client of `operator` is alive."""
        self._heard_at[operator] = self._clock()
        if self._keeper is operator and self._lease.holder(self._clock()) is operator:
            self._lease.take(operator, self._clock(), KEPT)

    def switch_motors(self, operator: Operator, *, on: bool) -> Refusal | None:
        """Switch the motors' power."""
        if on and (refused := self._rule(operator, take_over=False)):
            return refused
        return self._robot.arbiter.set_motors(on=on)

    def take_over(self, operator: Operator) -> Refusal | None:
        """Stop the robot, and give control to `operator`; the operator before is told."""
        if refused := self._rule(operator, take_over=True):
            return refused
        before = self.holder
        if before is not operator:
            self._inputs.stop(f"{operator.name} took over")
            self._stopping_until = self._clock() + STOPPING
        self._pass_to(operator)
        if before is not None and before is not operator:
            self._tell(before, f"{operator.name} took over; you watch now")
        return None

    def hand_over(self, operator: Operator, to: Operator) -> Refusal | None:
        """Stop the robot, and pass control on to another."""
        if self.holder is not operator:
            return Refusal("you do not have control")
        self._inputs.stop()
        self._stopping_until = self._clock() + STOPPING
        self._pass_to(to)
        self._tell(to, f"{operator.name} has handed control to you")
        return None

    def release(self, operator: Operator) -> None:
        """End the control of `operator`, who gives it up or has left: the robot stops at once."""
        if self._starter() is operator:
            self._robot.arbiter.end_mode(f"{operator.name} let go")
        if self._lease.holder(self._clock()) is operator:
            self._inputs.release_all()
        self._lease.release(operator)
        if self._keeper is operator:
            self._keeper = None
        self._heard_at.pop(operator, None)

    def _pass_to(self, operator: Operator) -> None:
        if holder := self._lease.holder(self._clock()):
            self._lease.release(holder)
        self._mode = None
        self.take(operator, keep=True)

    def _starter(self) -> Operator | None:
        """Return the operator who started the running mode."""
        if self._mode is None or self._robot.arbiter.mode is not self._mode[1]:
            return None
        return self._mode[0]

    def _silence(self, operator: Operator) -> float:
        """Return the time since the client of `operator` was heard of [s], `inf` if it is gone."""
        return self._clock() - self._heard_at.get(operator, float("-inf"))

    def _watch_silence(self, operator: Operator, mode: Stack, patience: float) -> None:
        """End `mode` once the client of `operator`, who started it, has fallen silent."""
        if self._robot.arbiter.mode is not mode:
            return
        left = patience - self._silence(operator)
        if left > 0:
            again = asyncio.get_running_loop().call_later
            again(left, self._watch_silence, operator, mode, patience)
        else:
            self._end(mode, _nothing_heard(operator, patience))

    def _end(self, mode: Stack, why: str) -> None:
        if self._robot.arbiter.mode is mode:
            self._robot.arbiter.end_mode(why)

    def _stopping(self) -> Refusal | None:
        """Return a refusal while the robot still comes to a stand after a take-over."""
        snapshot = self._robot.snapshot
        if self._clock() >= self._stopping_until or snapshot is None:
            return None
        if stands(snapshot):
            self._stopping_until = float("-inf")
            return None
        return Refusal("the robot is still stopping")


def _nothing_heard(operator: Operator, seconds: float) -> str:
    return f"nothing was heard of {operator.name} for {seconds:g} s"
