"""Decides the motion of a robot from velocity commands and snapshots. No I/O, no clock.

Rules:

1. A velocity command expires. Then, and on every doubt, the robot is told to stand still.
2. A twist is repeated while the robot moves or should: a lost frame costs 0.25 s at most.
3. Motors are switched on when a command needs them, and only then, again and again until a
   snapshot confirms it. Motors are switched off when the robot stands: without power it rolls on.
4. A command from before the last stop is ignored (:mod:`pioneer3.stops`).
5. The emergency stop latches. Resetting it leaves the motors off.
6. Only the newest of each kind waits for the link (:class:`MotionRequest`), never a queue. A
   changed twist does not wait for the repetition of an old one.
"""

from dataclasses import KW_ONLY, dataclass, replace
from math import inf

from pioneer3.errors import Refusal
from pioneer3.geometry import STILL, Twist2
from pioneer3.limits import Accelerations, Limits
from pioneer3.robot.limits import limit
from pioneer3.state import Snapshot
from pioneer3.stops import Stop, leads_away

REPEAT = 0.2
"""Pause between repetitions of a velocity [s]."""
SHARED = 0.05
"""A repetition is this much early or late [s] if a report or a command comes then: to wake up for
it alone costs more than all the rest of it."""
MIN_INTERVAL = 0.05
"""Shortest interval between changed velocities [s]: both frames take 19 ms at 9600 baud. A stop
never waits."""
BURST = 3
"""Number of changed velocities that may come at once before the interval holds."""
ENABLE_RETRY = 0.5
ENABLE_TRIES = 4
STANDING = Twist2(0.005, 0.01)
"""Slower than this counts as standing [m/s, rad/s]."""
REPORT_TIMEOUT = 0.5
"""A robot that has sent no report for this long [s] is told to stand until the next one."""
BRAKING = 1.0
"""Longest wait for the robot to stand before its motors are switched off [s]."""
STALL_RECOVERY = 1.0
"""Time that a command away from a stall has to free the wheels [s]."""
HELD = 2.0
"""A command that a pressed bumper has held up for so long is over [s]."""
STOPPED = "somebody stopped the robot"
STALLED = "the wheels stalled"
BUMPED = "a bumper was pressed"
LATCHED = Refusal("the emergency stop is latched")
NO_ROBOT = Refusal("no robot is connected")
LONGEST_PAUSE = 2.0
"""After a longer pause of this program [s] the robot's watchdog has stopped the robot."""


@dataclass(frozen=True, slots=True)
class VelocityCommand:
    """A velocity command of the arbiter; without `accelerations` those of the robot hold.

    Attributes:
        until: Latest time of expiry [s, loop time].
        after: Number of the last stop when this was decided.
        answers_stall: Whether this frees stalled wheels.
    """

    twist: Twist2
    until: float = inf
    _: KW_ONLY
    after: int
    answers_stall: bool = False
    accelerations: Accelerations | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionRequest:
    """The motion that is due: the newest of each kind, stops first; `None` changes nothing.

    A `stop` is at the set deceleration, a `hard_stop` as hard as the robot can.
    """

    stop: bool = False
    hard_stop: bool = False
    accelerations: Accelerations | None = None
    motors: bool | None = None
    twist: Twist2 | None = None


NOTHING_DUE = MotionRequest()


def stands(snapshot: Snapshot) -> bool:
    """Whether a robot moves more slowly than :data:`STANDING`."""
    measured = snapshot.odometry.twist
    return abs(measured.v) < STANDING.v and abs(measured.w) < STANDING.w


class Pilot:
    """Decides the motion of one robot, over all sessions with it.

    Four things tell why a command does not count:

    * `refusal`: nothing may drive a robot of this type; set with each session.
    * `forbidden`: the emergency stop is latched, or there is a `refusal`; no command counts.
    * `last_stop.told`: the command began before the last stop; a fresh one counts.
    * `blocked`: why people have to ask anew, until a command counts; in words only.

    Attributes:
        deadline: Time of the next call of :meth:`tick` [s, monotonic, as every `now`].
        limits: Bounds of the present robot, or `None` before the first session.
        auto_enable: Whether a command switches the motors on.
        last_stop: A command must have begun after this stop.
        drove: Whether a command of this session may have moved the robot.
        sent: The last twist sent [m/s, rad/s]; `None` while raw commands drive the robot.
    """

    def __init__(self, *, auto_enable: bool = True) -> None:
        self.deadline = inf
        self.limits: Limits | None = None
        self.emergency = False
        self.auto_enable = auto_enable
        self.last_stop = Stop()
        self.drove = False
        self.refusal: str | None = None
        self.blocked: str | None = None
        self.sent: Twist2 | None = None
        self._request = NOTHING_DUE
        self._snapshot: Snapshot | None = None
        self._command = VelocityCommand(STILL, after=0)
        self._until = -inf
        self._checked_at = -inf
        self._sent_at = self._stopped_at = self._interval_until = -inf
        self._recovering_from: Stop | None = None
        self._recovery_until = -inf
        self._bumped_since = inf
        self._accelerations: Accelerations | None = None
        self._left_to_raw_commands = False
        self._motors_wanted: bool | None = None
        self._motors_wanted_at = -inf
        self._motors_seen = False
        self._enable_tries = 0
        self._enabled: bool | None = None
        self._enabled_at = self._observed_at = -inf

    def session_opened(self, limits: Limits, now: float, *, refusal: str | None = None) -> None:
        """Stop the robot, and keep its `limits`; with a `refusal` nothing may drive it."""
        self.limits, self.refusal = limits, refusal
        self.drove = False
        self._accelerations = limits.accelerations
        self._request = MotionRequest(stop=True)
        self._count_stop(self.last_stop.why)  # commands from before the connection do not count
        self.sent, self._sent_at, self._checked_at = STILL, -inf, now
        self.deadline = now + REPEAT

    def session_lost(self, why: str, now: float) -> None:
        """Forget all commands: none may reach the next session."""
        self._request = NOTHING_DUE
        self._snapshot, self.sent, self._left_to_raw_commands = None, None, False
        self._motors_wanted, self._motors_seen, self._enable_tries = None, False, 0
        self.deadline = inf
        self._block(f"the link was lost ({why})", now)

    def drive(self, command: VelocityCommand, now: float) -> Refusal | None:
        """Obey `command` from `now` [s] on."""
        if self.limits is None:
            return NO_ROBOT
        if self.forbidden:
            return self.forbidden
        if self._snapshot is None:
            return self.last_stop.told if self.blocked else NO_ROBOT
        if self.last_stop.outdates(command.after):
            return self.last_stop.told
        if command is self._command and now < self._until and not self.enable_failed:
            self._until = min(now + self.limits.expiry, command.until)  # it only goes on
            return None
        twist, stalled = command.twist, self.last_stop.stalled
        self.blocked, self._left_to_raw_commands = None, False
        if (
            stalled is not None
            and self._recovering_from != self.last_stop
            and leads_away(twist, stalled)
        ):
            self._recovering_from, self._recovery_until = self.last_stop, now + STALL_RECOVERY
        if self.enable_failed and self.asked(now).is_zero:
            self._motors_wanted = None  # a fresh command tries the motors again
        self._command, self._until = command, min(now + self.limits.expiry, command.until)
        if not twist.is_zero and self.auto_enable and not self._motors_wanted:
            self._want_motors(on=True, now=now)
        self._update_velocity(now)
        return None

    def stop(self, now: float, why: str = STOPPED) -> None:
        """Stand still, at the set deceleration; commands from before end by this reason."""
        self._forget_command()
        self._left_to_raw_commands = False
        if self._snapshot is None:
            self._count_stop(self.last_stop.why)
        else:
            self.blocked = None
            self._count_stop(why)
        self._request = replace(self._request, twist=None)
        if self.sent != STILL or now >= self._stopped_at + MIN_INTERVAL:
            self._request = replace(self._request, stop=True)
            self._stopped_at = now
        self.sent, self._sent_at = STILL, now

    def emergency_stop(self, now: float) -> None:
        """Stop as hard as the robot can, motors off, until :meth:`reset_emergency_stop`."""
        self.stop(now)
        if self._request.stop or not self.emergency:
            self._request = replace(self._request, hard_stop=True)
        self.emergency = True
        self._block("the emergency stop was pressed", now)
        self._want_motors(on=False, now=now)

    def reset_emergency_stop(self) -> None:
        """Release the latch; the motors stay off until a command needs them."""
        if self.emergency:
            self.emergency = False
            self._count_stop(self.last_stop.why)

    def leave_to_raw_commands(self, now: float) -> None:
        """Leave motion to raw commands until :meth:`stop` or a fresh velocity command."""
        self._block("a raw command drives the robot", now)
        self._left_to_raw_commands, self.sent = True, None
        self.drove = True

    def set_motors(self, *, on: bool, now: float) -> Refusal | None:
        """Switch the motors on, or off once the robot stands."""
        if on and self.forbidden:
            return self.forbidden
        stood = self.stands
        self.stop(now)
        self._want_motors(on=on, now=-inf if stood else now)
        self._update_motors(now)
        return None

    def observe(self, snapshot: Snapshot, now: float) -> None:
        """Act on a new snapshot."""
        motors, before = snapshot.motors, self._snapshot
        self._snapshot, self._observed_at = snapshot, now
        self._check_pause(now)
        if motors.stop_button:
            if self._motors_wanted:
                self._motors_wanted = None  # its release does not switch them on again
            self._block("the stop button on the robot is pressed", now)
        elif motors.stalled and self._stall_ends_command(now):
            self._block(STALLED, now, stalled=self._command.twist)
        elif self._motors_seen and not motors.enabled and self._motors_wanted:
            self._motors_wanted = None
            self._block("the robot switched its motors off", now)
        if not motors.stalled:
            self._recovery_until = -inf
        self._motors_seen = motors.enabled
        if motors.enabled:
            self._enable_tries = 0
        if before is None and self._motors_wanted is None:
            self._want_motors(on=False, now=-inf if self._at_rest else now)
        self._update_motors(now)
        self._update_velocity(now)

    def tick(self, now: float) -> None:
        """Let the velocity command expire."""
        self._check_pause(now)
        self.deadline = now + REPEAT
        self._update_velocity(now)

    @property
    def is_due(self) -> bool:
        """Whether :meth:`outgoing` has something to send."""
        return self._request is not NOTHING_DUE

    def outgoing(self) -> MotionRequest:
        """Return and forget the motion that is due."""
        request, self._request = self._request, NOTHING_DUE
        return request

    @property
    def forbidden(self) -> Refusal | None:
        """The refusal of all commands until somebody sees to it, or `None`."""
        if self.emergency:
            return LATCHED
        return Refusal(self.refusal) if self.refusal else None

    def asked(self, now: float) -> Twist2:
        """Return the twist of the velocity command at `now` [s], before limits."""
        return self._command.twist if now < self._until else STILL

    @property
    def stands(self) -> bool:
        """Whether the robot was told to stand, and does; or its motors have no power."""
        if self._snapshot is None or not self._snapshot.motors.enabled:
            return True
        return self.sent == STILL and self._at_rest and self._observed_at > self._sent_at

    @property
    def asked_for_motion(self) -> bool:
        """Whether the last velocity command was not zero; it may have expired since."""
        return not self._command.twist.is_zero

    @property
    def switches_on(self) -> bool:
        """Whether the motors are to come on, and stay on."""
        return bool(self._motors_wanted)

    @property
    def enable_failed(self) -> bool:
        """Whether ENABLE was sent often enough, and the motors did not come on."""
        return self.switches_on and self._enable_tries >= ENABLE_TRIES

    def _check_pause(self, now: float) -> None:
        pause, self._checked_at = now - self._checked_at, now
        if pause > LONGEST_PAUSE and self._snapshot is not None:
            self._block(f"the watchdog stopped the robot: this program slept {pause:.1f} s", now)

    def _stall_ends_command(self, now: float) -> bool:
        """Return whether wheels that are stalled now end the present command."""
        command = self._command
        return not (command.twist.is_zero or command.answers_stall or now < self._recovery_until)

    def _block(self, why: str, now: float, *, stalled: Twist2 | None = None) -> None:
        self.blocked = why
        self._count_stop(why, stalled)
        self._forget_command()

    def _forget_command(self) -> None:
        self._command = VelocityCommand(STILL, after=self.last_stop.number)
        self._until = -inf

    def _count_stop(self, why: str, stalled: Twist2 | None = None) -> None:
        self.last_stop = Stop(self.last_stop.number + 1, why, stalled)

    def _want_motors(self, *, on: bool, now: float) -> None:
        """Set the wanted state of the motors; off begins at `now`, once the robot stands."""
        self._motors_wanted, self._motors_wanted_at = on, now
        self._enable_tries = 0

    @property
    def _at_rest(self) -> bool:
        """Whether the robot stood in the last snapshot."""
        return self._snapshot is not None and stands(self._snapshot)

    def _update_motors(self, now: float) -> None:
        """Bring the motors to the wanted state; switching on has :data:`ENABLE_TRIES`."""
        if self._snapshot is None or self._motors_wanted is None:
            return
        wanted = self._motors_wanted
        if wanted == self._snapshot.motors.enabled:
            if not wanted and not self.emergency:
                self._motors_wanted = None  # they are off; a person at the robot may turn them on
            return
        if wanted and (self._snapshot.motors.stop_button or self.enable_failed):
            return
        if not wanted and self._still_stopping(now):
            return
        again = ENABLE_RETRY if wanted == self._enabled else MIN_INTERVAL
        if now >= self._enabled_at + again:
            self._enabled, self._enabled_at = wanted, now
            self._enable_tries += 1
            self._request = replace(self._request, motors=wanted)
            self.drove |= wanted

    def _still_stopping(self, now: float) -> bool:
        """Return whether motors to be switched off are still needed to stop the robot."""
        return not (self.emergency or self.stands) and now < self._motors_wanted_at + BRAKING

    def _update_velocity(self, now: float) -> None:
        """Send the velocity that is due."""
        snapshot, limits = self._snapshot, self.limits
        if snapshot is None or limits is None or self._left_to_raw_commands:
            return
        self._update_motors(now)
        self._set_accelerations(limits)
        silent = now - self._observed_at > REPORT_TIMEOUT
        twist = STILL if silent else limit(self.asked(now), limits, snapshot.bumpers)
        self._check_bumpers(twist, now)
        due = now >= self._sent_at + REPEAT - SHARED and not (twist.is_zero and self._at_rest)
        change_at = self._interval_until - (BURST - 1) * MIN_INTERVAL
        changed = twist != self.sent and (twist.is_zero or now >= change_at)
        if changed and not twist.is_zero:
            self._interval_until = max(self._interval_until, now) + MIN_INTERVAL
        if changed or due:
            self._request = replace(self._request, twist=twist)
            self.drove |= not twist.is_zero
            self.sent, self._sent_at = twist, now
        again = self._sent_at + REPEAT + SHARED if twist == self.sent else change_at
        power_at = inf if self._motors_wanted else self._motors_wanted_at + BRAKING
        rests = now + (REPORT_TIMEOUT if twist.is_zero and self._at_rest else REPEAT + SHARED)
        due_at = (again, self._until, power_at, rests)
        self.deadline = min([due for due in due_at if due > now])

    def _check_bumpers(self, twist: Twist2, now: float) -> None:
        """End a command that leaves no motion but `twist`: later it would surprise people."""
        asked = self.asked(now)
        held = twist.is_zero and not asked.is_zero
        self._bumped_since = min(self._bumped_since, now) if held else inf
        if now - self._bumped_since >= HELD:
            self._block(BUMPED, now, stalled=asked)

    def _set_accelerations(self, limits: Limits) -> None:
        """Ask for the wanted accelerations if they are new."""
        wanted = self._command.accelerations or limits.accelerations
        if wanted != self._accelerations:
            self._accelerations = wanted
            self._request = replace(self._request, accelerations=wanted)
