"""The one place where wishes become velocities: actions in, one request to the robot out."""

import asyncio
import logging
from collections.abc import Callable
from dataclasses import dataclass

from pioneer3.behaviors.actions import Hold
from pioneer3.behaviors.engine import ActionError, Decision, resolve
from pioneer3.behaviors.memory import RangeMemory
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.stack import Action, Stack
from pioneer3.behaviors.words import told, why_standing
from pioneer3.geometry import STILL, Twist2
from pioneer3.limits import Limits, Pace
from pioneer3.runtime.driven import Drivable
from pioneer3.state import Scan, Snapshot

log = logging.getLogger(__name__)

STOPPED = "somebody stopped the robot"


@dataclass(frozen=True, slots=True)
class Ended:
    """How a mode ended: whether it had done what it was for, and a few words."""

    mode: Stack
    done: bool
    why: str


class Helm:
    """Asks every action and tells the robot, at each reading and at each change.

    Args:
        supervisor: Of the robot.
        remark: Told in words what was decided, whenever that changes.

    Attributes:
        decision: The last one.
        mode: The stack that was started last and has not ended, or `None`.
        latest_scan: Returns what a laser last saw, while one is on.
        ended: How the last mode ended; `None` while one runs and before the first.
    """

    def __init__(self, supervisor: Drivable, remark: Callable[[str], None] | None = None) -> None:
        self.decision = Decision()
        self.mode: Stack | None = None
        self.ended: Ended | None = None
        self.latest_scan: Callable[[], Scan | None] = lambda: None
        self._supervisor = supervisor
        self._remark = remark
        self._remarked: str | None = None
        self._stacks: list[Stack] = []
        self._memory: RangeMemory | None = None
        self._clock = asyncio.get_running_loop().time
        supervisor.on_reading = self._take

    @property
    def driver(self) -> str | None:
        """Name of the action that drives, or `None`."""
        if self._clock() >= self.decision.until:
            return None
        return self.decision.v_by or self.decision.w_by

    def situation(self) -> Situation | None:
        """Return what actions see now, or `None` without a robot."""
        snapshot, info = self._supervisor.snapshot, self._supervisor.info
        if snapshot is None or info is None or self._memory is None:
            return None
        now = self._clock()
        return Situation(
            now=now,
            snapshot=snapshot,
            model=info.model,
            limits=info.limits,
            around=self._memory.around(now),
        )

    def decide(self, *, renewed: bool = False) -> str | None:
        """Resolve now; return why the robot ignores the result, or `None`.

        `renewed` says that nobody has asked for anything new: only time has passed.
        """
        situation, before = self.situation(), self.decision
        if situation is None:
            return self._supervisor.why_not_moving()
        try:
            self.decision = decision = resolve(self._stacks, situation)
        except ActionError as error:
            return self._fail(error)
        if self._remark is not None:
            self._tell(self._remark)
        refused = self._supervisor.pilot.refusal(despite_stall=decision.despite_stall)
        if refused and self.mode is not None:
            # even one that waits: it would go on by itself once somebody asks for something fresh
            self._forget_mode(refused)
            self.decision = Decision()
            return refused
        if decision.wanted:
            return self._supervisor.drive(
                decision.twist,
                decision.until,
                renewed=renewed,
                despite_stall=decision.despite_stall,
                pace=_pace(decision, situation.limits),
            )
        if before.wanted and situation.now < before.until:  # let go; the pilot ends what expires
            return self._supervisor.drive(STILL)
        return None

    def why_not_moving(self) -> str | None:
        """Return in one sentence why the robot stands still, or `None` while it moves."""
        return self._supervisor.why_not_moving(why_standing(self.decision))

    def add(self, action: Action, priority: int) -> None:
        """Let `action` take part from now on."""
        self._stacks.append(Stack.alone(action, priority))

    def remove(self, action: Action) -> None:
        """Take `action` out; what it wanted ends at once."""
        if action in self:
            self._stacks = [stack for stack in self._stacks if not _has(stack, action)]
            self.decide()

    def __contains__(self, action: Action) -> bool:
        return any(_has(stack, action) for stack in self._stacks)

    def start(self, mode: Stack) -> str | None:
        """Stop, then let `mode` drive in place of the one before; return why it does not."""
        self.stop()
        self.mode, self.ended = mode, None
        self._stacks.append(mode)
        return self.decide()

    def end_mode(self, why: str) -> None:
        """End the mode, if any; its motion ends at once."""
        if self.mode is not None:
            self._forget_mode(why)
            self.decide()

    def hold(self, held: Hold, twist: Twist2, seconds: float) -> str | None:
        """Let `held` want `twist` for `seconds`; return why the robot ignores it, or `None`."""
        held.set(twist, self._clock(), seconds)
        if held.muted:
            return f"{STOPPED}; let go, then ask again"
        if self._supervisor.snapshot is None:  # refused, but noted: a held key is not a fresh one
            return self._supervisor.drive(twist)
        return self.decide()

    def release(self, held: Hold) -> None:
        """Let go by hand: the robot stops if nobody else drives; the next wish is a fresh one."""
        held.release()
        self.decide()
        if not self.decision.wanted:
            self._supervisor.drive(STILL)

    def stop(self, by: Hold | None = None) -> None:
        """End every wish and stand still; what others than `by` hold must be let go first."""
        self._end_wishes(by)
        self._supervisor.stop()

    def emergency_stop(self) -> None:
        """End every wish and stop hard, latched."""
        self._end_wishes(None)
        self._supervisor.emergency_stop()

    def set_motors(self, *, on: bool, by: Hold | None = None) -> str | None:
        """Stop as :meth:`stop` does, then switch the motors; return why not, or `None`."""
        self.stop(by)
        return self._supervisor.set_motors(on=on)

    def _take(self, snapshot: Snapshot) -> None:
        """Decide anew at each reading."""
        info = self._supervisor.info
        if info is not None and (self._memory is None or self._memory.model is not info.model):
            self._memory = RangeMemory(info.model)
        if self._memory is not None:
            self._memory.update(snapshot, self.latest_scan())
        self.decide(renewed=True)
        if self.mode is not None and self.mode.done:
            self._forget_mode("done", done=True)
            self.decide()

    @property
    def told(self) -> tuple[str, ...]:
        """Who decides what and why, a sentence each; nothing while nobody drives."""
        return told(self.decision) if self._clock() < self.decision.until else ()

    def _tell(self, remark: Callable[[str], None]) -> None:
        words = "; ".join(self.told)
        if words != self._remarked:
            self._remarked = words
            who = self.mode.name if self.mode else "driver"
            remark(f"{who}: {words or 'nothing is asked'}")

    def _fail(self, error: ActionError) -> str:
        """End the stack of an action that failed, and stand still."""
        log.error("%s stops the robot", error, exc_info=error)
        if self.mode is not None and self.mode.name == error.stack:
            self._forget_mode(str(error))
        self._stacks = [stack for stack in self._stacks if stack.name != error.stack]
        self.stop()
        return str(error)

    def _forget_mode(self, why: str, *, done: bool = False) -> None:
        mode, self.mode = self.mode, None
        if mode is not None:
            self._stacks = [stack for stack in self._stacks if stack is not mode]
            self.ended = Ended(mode, done, why)

    def _end_wishes(self, by: Hold | None) -> None:
        if self.mode is not None:
            self._forget_mode(STOPPED)
        kept = []
        for stack in self._stacks:
            for ranked in stack.actions:
                if isinstance(ranked.action, Hold):
                    kept.append(stack)
                    _let_go(ranked.action, by, self._clock())
        self._stacks = kept
        self.decision = Decision()


def _let_go(held: Hold, by: Hold | None, now: float) -> None:
    if held is by:
        held.release()
    else:
        held.mute(now)


def _has(stack: Stack, action: Action) -> bool:
    return any(ranked.action is action for ranked in stack.actions)


def _pace(decision: Decision, limits: Limits) -> Pace:
    """Return the accelerations to drive with: never faster up, never softer down than wanted."""
    wanted = decision.limits
    if not wanted:
        return limits.pace
    return Pace(
        min(wanted.get("acceleration", limits.acceleration), limits.acceleration),
        max(wanted.get("deceleration", 0.0), limits.deceleration),
        min(wanted.get("turn_acceleration", limits.turn_acceleration), limits.turn_acceleration),
        max(wanted.get("turn_deceleration", 0.0), limits.turn_deceleration),
    )
