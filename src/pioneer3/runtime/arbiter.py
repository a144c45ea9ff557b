"""The arbiter: resolves all actions into one velocity command for the robot."""

import asyncio
import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from math import inf
from typing import Any, Protocol

from pioneer3.behaviors.action import MODE, Action, ProgressChecker, Situation, Stack
from pioneer3.behaviors.actions import Hold
from pioneer3.behaviors.actions.keep_apart import LimiterPeers
from pioneer3.behaviors.actions.limiters import LimiterBySonar
from pioneer3.behaviors.engine import ActionError, Decision, resolve
from pioneer3.behaviors.explanations import explain, explain_standstill
from pioneer3.behaviors.memory import RangeMemory
from pioneer3.behaviors.peers import Peers
from pioneer3.behaviors.surroundings import NOTHING_SENSED
from pioneer3.errors import Refusal
from pioneer3.geometry import STILL, Twist2
from pioneer3.limits import Accelerations, Limits
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.robot.explain import Reason
from pioneer3.robot.pilot import STOPPED, Pilot, VelocityCommand, stands
from pioneer3.robot.supervisor import ConnectionStatus, Feed, RobotInfo
from pioneer3.runtime.recording import EMERGENCY_STOP, RESET, CommandGiven, RobotLog
from pioneer3.state import Snapshot
from pioneer3.stops import Freshness, Stop

GAMEPAD = 100
KEYBOARD = 90
WEB = 80
PROGRAM = 50
"""Priorities of inputs, above that of modes: the order of twist_mux (facts.md 14.6)."""
KEEP_APART = 10
"""Priority of the limiter by other robots: it knows the turn that is asked for."""
LAST_CHECK = 0
"""Priority of the limiter by walls, below all: it knows the motion that all others ask for."""

SENT_AFTER = 0.001
"""A command is on the wire after so long [s]: only then its reason to stand is looked for."""
MOMENT = 2.0
"""A mode that has stood for so long for want of what it must know ends [s]."""

log = logging.getLogger(__name__)


class Drivable(Protocol):
    """The part of a robot that an arbiter drives it by, at a cable or over topics.

    Attributes:
        info: Of the robot last connected, or `None`.
        snapshot_taken: Called with every snapshot, before the feed `snapshots` has it.
    """

    pilot: Pilot
    snapshots: Feed[Snapshot]
    status: Feed[ConnectionStatus]
    info: RobotInfo | None
    snapshot_taken: Callable[[Snapshot], None]

    @property
    def snapshot(self) -> Snapshot | None:
        """The latest snapshot, or `None` without a connection."""

    @property
    def without_power(self) -> bool:
        """Whether the robot reports that its motors have no power, as after an emergency stop."""

    @property
    def taken(self) -> bool:
        """Whether another program drives the robot, and this one watches."""

    def drive(self, command: VelocityCommand) -> Refusal | None:
        """Drive as :meth:`Pilot.drive` does."""

    def stop(self, why: str = STOPPED) -> None:
        """Stand still."""

    def emergency_stop(self) -> None:
        """Stop hard, motors off, latched."""

    def reset_emergency_stop(self) -> None:
        """Release the latch; the motors stay off."""

    def set_motors(self, *, on: bool) -> Refusal | None:
        """Switch the motors' power."""

    def why_not_moving(self, decided: str | None = None) -> Reason | None:
        """Return the reason that the robot stands still, or `None` while it moves."""


@dataclass(frozen=True, slots=True)
class Ended:
    """The end of a mode: whether it reached its aim, and the reason in a few words.

    Attributes:
        place: Name of the place that it went to, or empty.
    """

    mode: Stack
    done: bool
    why: str
    place: str = ""


@dataclass(slots=True)
class _Part:
    """A stack that takes part in driving; a :class:`Hold` has a freshness of its own, too."""

    stack: Stack
    freshness: Freshness
    is_held: bool

    def is_idle(self, now: float) -> bool:
        """Return whether it is an input that asks for nothing."""
        if not self.is_held or len(self.stack.actions) > 1:
            return False
        held = self.stack.actions[0].action
        return isinstance(held, Hold) and now >= held.until


class Arbiter:
    """Asks every action and commands the robot, at each snapshot and at each change.

    It tells its log each snapshot, command and decision.

    Attributes:
        mode: The stack that was started last and has not ended, or `None`.
        lasers: That it looks through, while they are on.
        log: The log of the robot, if there is one.
        ended: The end of the last mode; `None` while one runs and before the first.
        remembers: Whether it keeps what the sensors have seen. Inputs do not need it, and it costs
            half of all: who drives a crowd by hand sets it to false. It is true again from the
            first action that is no input.
    """

    def __init__(self, supervisor: Drivable, robot_log: RobotLog | None = None) -> None:
        self.decision = Decision()
        self.mode: Stack | None = None
        self.ended: Ended | None = None
        self.lasers: Sequence[LaserSource] = ()
        self.remembers = True
        self._supervisor = supervisor
        self.log = robot_log
        self._parts: list[_Part] = []
        self._stop_before_decision = self.last_stop
        self._memory: RangeMemory | None = None
        self._progress = ProgressChecker()
        self._lacks_since = inf
        self._laser_on = ExitStack()
        self._by_sonar = Stack.alone(LimiterBySonar(), MODE)
        self._apart: Stack | None = None
        self._last_checks: list[Stack] = []
        self._alone: tuple[object, Decision] = None, self.decision
        self._commanded = self.decision, self.last_stop, VelocityCommand(STILL, after=0)
        self._loop = asyncio.get_running_loop()
        self._clock = self._loop.time
        supervisor.snapshot_taken = self._take

    @property
    def driving_action(self) -> str | None:
        """Name of the action that drives, or `None`."""
        if self._clock() >= self.decision.until:
            return None
        return self.decision.v_by or self.decision.w_by

    def situation(self) -> Situation | None:
        """Return the situation that actions decide in, or `None` without a robot."""
        return self._situation(self._clock())

    def _situation(self, now: float) -> Situation | None:
        snapshot, info = self._supervisor.snapshot, self._supervisor.info
        if snapshot is None or info is None or self._memory is None:
            return None
        return Situation(
            now=now,
            snapshot=snapshot,
            model=info.model,
            limits=info.limits,
            around=self._memory.around(now) if self.remembers else NOTHING_SENSED,
            scan=self._memory.newest_scan(now),
            lost_lasers=tuple(laser.lost for laser in self.lasers if laser.lost),
            last_stop=self.last_stop,
        )

    @property
    def last_stop(self) -> Stop:
        """The stop that a command must have begun after."""
        return self._supervisor.pilot.last_stop

    def keep_apart(self, peers: Peers | None) -> None:
        """Keep the robot apart from others from now on, whoever drives it; `None` knows none."""
        self._apart = Stack.alone(LimiterPeers(peers=peers), KEEP_APART) if peers else None

    @contextmanager
    def checking(self, limiter: Action) -> Iterator[None]:
        """Ask a limiter last, whatever mode drives, during the block."""
        check = Stack.alone(limiter, LAST_CHECK)
        self._last_checks.append(check)
        try:
            yield
        finally:
            self._last_checks = [each for each in self._last_checks if each is not check]

    def decide(self) -> Refusal | None:
        """Resolve now, and drive by the result."""
        before, now, last = self.decision, self._clock(), self.last_stop
        info = self._supervisor.info
        if self._supervisor.snapshot is None or info is None or self._memory is None:
            why = self._supervisor.why_not_moving()
            return why and Refusal(why.text)
        self._end_motions()
        try:
            self.decision = decision = self._resolved(self._stacks(now), now)
        except ActionError as error:
            return self._fail(error)
        mode = self.mode.name if self.mode else ""
        if why_it_ends := self._why_mode_ends(decision):
            self._note_decision(mode, decision, info.limits, now)
            self._forget_mode(why_it_ends)
            self.decide()
            return Refusal(why_it_ends)
        drove = before.wanted and now < before.until
        refused = self._drive(decision, info.limits, last, drove=drove)
        self._note_decision(mode, decision, info.limits, now)
        return refused

    def _drive(
        self, decision: Decision, limits: Limits, last: Stop, *, drove: bool
    ) -> Refusal | None:
        """Drive by a decision made after the stop `last`; stand if it lets go of one that drove."""
        if decision.wanted:
            self._stop_before_decision = last
            return self._supervisor.drive(self._command(decision, limits, last))
        stopped = last != self._stop_before_decision
        self._stop_before_decision = last
        if drove and not stopped:
            return self._stand()  # somebody let go; the pilot itself ends what expires
        return None

    def _command(self, decision: Decision, limits: Limits, last: Stop) -> VelocityCommand:
        """Return the command of a decision, the same one for the same decision."""
        decided, after, command = self._commanded
        if decided is not decision or after is not last:
            command = VelocityCommand(
                decision.twist,
                decision.until,
                after=last.number,
                answers_stall=decision.answers_stall,
                accelerations=_accelerations(decision, limits),
            )
            self._commanded = decision, last, command
        return command

    def _resolved(self, stacks: list[Stack], now: float) -> Decision:
        """Return the decision; that of a hold alone is the last one while it wants the same."""
        if not stacks:
            return Decision()
        alone = stacks[0].actions[0].action if len(stacks) == len(stacks[0].actions) == 1 else None
        if not (isinstance(alone, Hold) and alone.holds(now, self.last_stop)):
            return self._resolved_anew(stacks, now)
        (wanted, decision), wants = self._alone, (alone.name, alone.twist)
        if wants != wanted:
            decision = self._resolved_anew(stacks, now)
        elif alone.until != decision.until:
            decision = Decision(  # `replace` takes longer than the rest of this
                decision.twist,
                alone.until,
                decision.contributions,
                decision.limits,
                decision.answers_stall,
            )
        self._alone = wants, decision
        return decision

    def _resolved_anew(self, stacks: list[Stack], now: float) -> Decision:
        situation = self._situation(now)
        assert situation is not None
        return resolve(stacks, situation)

    def _stacks(self, now: float) -> list[Stack]:
        """Return all stacks that decide; modes see no better than the sensors that work."""
        stacks = [part.stack for part in self._parts if not part.is_idle(now)]
        if self.mode is not None:
            stacks.append(self._by_sonar)
            stacks += self._last_checks
        if self._apart is not None and stacks:
            stacks.append(self._apart)
        return stacks

    def _end_motions(self) -> None:
        """Remove motions that began before the last stop and cannot answer it."""
        last = self.last_stop
        self._parts = [
            part
            for part in self._parts
            if part.is_held or part.stack is self.mode or part.freshness.ignored(last) is None
        ]

    def _why_mode_ends(self, decision: Decision) -> str | None:
        """Return the reason to end the mode, or `None`.

        A waiting mode ends too: else it would drive again after the next command.
        """
        if self.mode is None:
            return None
        if forbidden := self._supervisor.pilot.forbidden:
            return forbidden.text
        part = next(part for part in self._parts if part.stack is self.mode)
        if decision.answers_stall:
            part.freshness.answer(self.last_stop)
        return self.last_stop.why if part.freshness.ignored(self.last_stop) else None

    def _stand(self) -> Refusal | None:
        return self._supervisor.drive(VelocityCommand(STILL, after=self.last_stop.number))

    def why_not_moving(self) -> Reason | None:
        """Return the reason that the robot stands still, or `None` while it moves."""
        return self._supervisor.why_not_moving(explain_standstill(self.decision))

    def add(self, action: Action, priority: int) -> None:
        """Ask `action` from now on."""
        self._join(Stack.alone(action, priority))

    def remove(self, action: Action) -> None:
        """Remove `action`; its motion ends at once."""
        if action in self:
            self._parts = [part for part in self._parts if not _has(part.stack, action)]
            self.decide()

    def __contains__(self, action: Action) -> bool:
        return any(_has(part.stack, action) for part in self._parts)

    def _join(self, stack: Stack) -> None:
        holds = [isinstance(ranked.action, Hold) for ranked in stack.actions]
        self.remembers |= not all(holds)
        self._parts.append(_Part(stack, Freshness.new(self.last_stop), any(holds)))

    def start(self, mode: Stack) -> Refusal | None:
        """Stop, then let `mode` drive in place of the one before."""
        self.stop(why=f"the mode {mode.name} was started")
        self.mode, self.ended = mode, None
        self._progress, self._lacks_since = ProgressChecker(), inf
        info = self._supervisor.info
        if mode.wants_scans or (info is not None and not info.model.sonars):
            for laser in self.lasers:
                if laser.presence.there:
                    self._laser_on.enter_context(laser.wanted())
        self._join(mode)
        return self._note(mode.name, "start", self.decide())

    def end_mode(self, why: str) -> None:
        """End the mode, if any; its motion ends at once."""
        if self.mode is not None:
            self._forget_mode(why)
            self.decide()

    def hold(self, held: Hold, twist: Twist2, seconds: float) -> Refusal | None:
        """Let `held` ask for `twist` for `seconds`."""
        held.set(twist, self._clock(), seconds, self.last_stop)
        refused = held.ignored(self.last_stop) or self.decide()
        return self._note(held.name, "drive", refused, twist, seconds)

    def release(self, held: Hold) -> None:
        """Release `held`: the robot stops if nobody else drives."""
        held.release()
        self.decide()
        self._note(held.name, "let go")
        if not self.decision.wanted:
            self._stand()  # even if nothing drove: to let go answers the stop before

    def stop(self, by: Hold | None = None, *, why: str = STOPPED) -> None:
        """End every command and stand still; other holds count again only after a release.

        Modes and motions end with the reason `why`.
        """
        if by is not None:
            by.release()
        self._end_commands(why)
        self._supervisor.stop(why)
        self._note(by.name if by else "", f"stop: {why}")

    def emergency_stop(self) -> None:
        """End every command and stop hard, latched."""
        self._end_commands()
        self._supervisor.emergency_stop()
        self._note("", EMERGENCY_STOP)

    def reset_emergency_stop(self) -> None:
        """Release the latch; the motors stay off."""
        self._supervisor.reset_emergency_stop()
        self._note("", RESET)

    def set_motors(self, *, on: bool, by: Hold | None = None) -> Refusal | None:
        """Stop as :meth:`stop` does, then switch the motors."""
        self.stop(by)
        refused = self._supervisor.set_motors(on=on)
        return self._note(by.name if by else "", f"motors {'on' if on else 'off'}", refused)

    def _take(self, snapshot: Snapshot) -> None:
        """Decide anew at each snapshot."""
        info = self._supervisor.info
        if info is not None and (self._memory is None or self._memory.model is not info.model):
            self._memory = RangeMemory(info.model)
        scans = [scan for laser in self.lasers if (scan := laser.latest) is not None]
        if self.log is not None and info is not None:
            self.log.snapshot(snapshot, info.model, scans)
        if self._memory is not None and self.remembers:
            self._memory.update(snapshot, scans)
        self.decide()
        if self.mode is not None and self.mode.done:
            self._forget_mode("done", done=True)
            self.decide()
        elif self.mode is not None and (failed := self.mode.failed):
            self.end_mode(failed)
        if self.mode is not None:
            self._check_knowledge()
            self._check_progress(snapshot)
        self._log_reason()

    def _check_progress(self, snapshot: Snapshot) -> None:
        """End a mode that goes somewhere and does not get there."""
        here = snapshot.odometry.robot_in_odom
        if self.mode and not self._progress.check(self.mode.goal, here.x, here.y, snapshot.stamp):
            self.end_mode(": ".join(("something is in the way", *self.told)))

    def _check_knowledge(self) -> None:
        """End a mode that stands for want of knowledge: its going on would surprise people."""
        now, lacks = self._clock(), self.decision.lacking
        self._lacks_since = inf if lacks is None else min(self._lacks_since, now)
        if lacks is not None and now - self._lacks_since >= MOMENT:
            self.end_mode(f"{lacks}; start it again when that is mended")

    @property
    def told(self) -> tuple[str, ...]:
        """The actions that decide and their reasons, a sentence each; empty while nobody drives."""
        return explain(self.decision) if self._clock() < self.decision.until else ()

    def _note_decision(self, mode: str, decision: Decision, limits: Limits, now: float) -> None:
        """Put a decision into the log after its bytes, which do not wait for that."""
        if self.log is not None:
            self._loop.call_soon(self.log.decided, mode, decision, limits, now)

    def _note(
        self,
        by: str,
        command: str,
        refused: Refusal | None = None,
        twist: Twist2 = STILL,
        seconds: float = 0.0,
    ) -> Refusal | None:
        """Put a command into the log after its bytes; return its refusal."""
        if self.log is not None:
            why, now = refused.text if refused else "", self._clock()
            self._loop.call_soon(self._log_command, now, by, command, twist, seconds, why)
        return refused

    def _log_command(self, now: float, *told: Any) -> None:
        assert self.log is not None
        self.log.asked(CommandGiven(*told), now)
        snapshot = self._supervisor.snapshot
        if snapshot is None or stands(snapshot):
            self._loop.call_later(SENT_AFTER, self._log_reason)

    def _log_reason(self) -> None:
        """Put the reason that the robot stands still into the log."""
        if self.log is not None:
            self.log.stands(self.why_not_moving())

    def _fail(self, error: ActionError) -> Refusal:
        """End the stack of an action that failed, and stand still."""
        log.error("%s stops the robot", error, exc_info=error)
        if self.mode is not None and self.mode.name == error.stack:
            self._forget_mode(str(error))
        self._parts = [part for part in self._parts if part.stack.name != error.stack]
        self.stop()
        return Refusal(str(error))

    def _forget_mode(self, why: str, *, done: bool = False) -> None:
        mode, self.mode = self.mode, None
        self._laser_on.close()
        if mode is not None:
            self._parts = [part for part in self._parts if part.stack is not mode]
            self.ended = Ended(mode, done, why, _place_of(mode) if done else "")

    def _end_commands(self, why: str = STOPPED) -> None:
        """Remove all but the holds; the stop makes those ignored."""
        if self.mode is not None:
            self._forget_mode(why)
        self._parts = [part for part in self._parts if part.is_held]
        self.decision = Decision()


def _place_of(mode: Stack) -> str:
    """Return the name of the place that a mode goes to, or nothing."""
    goal = mode.goal
    return goal.name if goal else ""


def _has(stack: Stack, action: Action) -> bool:
    return any(ranked.action is action for ranked in stack.actions)


def _accelerations(decision: Decision, limits: Limits) -> Accelerations | None:
    """Return the accelerations to drive with: never faster up, never softer down than wanted.

    `None` are those of the robot.
    """
    wanted = decision.limits
    if not wanted:
        return None
    return Accelerations(
        min(wanted.get("acceleration", limits.acceleration), limits.acceleration),
        max(wanted.get("deceleration", 0.0), limits.deceleration),
        min(wanted.get("turn_acceleration", limits.turn_acceleration), limits.turn_acceleration),
        max(wanted.get("turn_deceleration", 0.0), limits.turn_deceleration),
    )
