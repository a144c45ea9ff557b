"""The robot's ARCOS commands, and their times. No I/O: velocity commands, snapshots, time come in.

Rules:

1. A velocity command expires. Then, and on every doubt, the robot is told to stand still.
2. VEL and RVEL are repeated while the robot moves or should: a lost frame costs 0.2 s at most.
3. Motors go on when a command needs them, and only then; seen in the snapshots, and retried. They
   go off when the robot stands: without power it would roll on.
4. A command that began before the last :class:`~pioneer3.stops.Stop` is ignored. The exception: a
   command that answers a stall (:class:`StallRecover`) goes on.
5. The emergency stop latches. Resetting it leaves the motors off.
6. What waits for the link is what the robot shall do now, never a queue: one frame of a kind, the
   newest, stops first. A changed velocity does not wait for the repetition of an old one.
"""

from dataclasses import KW_ONLY, dataclass, replace
from math import inf

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.geometry import STILL, Twist2
from pioneer3.limits import Accelerations, Limits
from pioneer3.robot.limits import limit
from pioneer3.state import Snapshot
from pioneer3.stops import Stop, leads_away

REPEAT = 0.2
"""Pause between repetitions of a velocity [s]."""
PACE = 0.05
"""Shortest pause between changed velocities that come one after the other [s]: both frames take
19 ms at 9600 baud. A stop never waits."""
BURST = 3
"""So many changed velocities may come at once before the pause holds."""
ENABLE_RETRY = 0.5
ENABLE_TRIES = 4
STANDING = Twist2(0.005, 0.01)
"""Slower than this counts as standing [m/s, rad/s]."""
BLIND = 0.5
"""A robot that has said nothing for this long [s] is told to stand until it speaks again."""
BRAKING = 1.0
"""Motors that go off wait this long [s] at most for the robot to stand."""
ESCAPE = 1.0
"""A robot that leads away from a stall has this long [s] to get its wheels free."""
STOPPED = "somebody stopped the robot"
STALLED = "the wheels stalled"
LATCHED = "the emergency stop is latched"
OVERSLEPT = 2.0
"""A host that was away for this long [s] finds that the robot's watchdog has stopped it."""


@dataclass(frozen=True, slots=True)
class VelocityCommand:
    """A velocity that the arbiter asks for.

    Attributes:
        twist: [m/s, rad/s].
        until: When it expires at the latest [s, loop time].
        after: Number of the last stop when this was first asked for.
        answers_stall: Whether this gets the wheels free.
        accelerations: How to get there; the robot's own if `None`.
    """

    twist: Twist2
    until: float = inf
    _: KW_ONLY
    after: int
    answers_stall: bool = False
    accelerations: Accelerations | None = None


@dataclass(slots=True)
class Outbox:
    """What is still to be sent: of each kind the newest, stops first.

    Attributes:
        emergency_stop: Whether to send ESTOP.
        stop: Whether to send STOP.
        power: What to say in ENABLE.
        settings: What prepares a session; sent once, in order.
        accelerations: Accelerations.
        velocity: [m/s, rad/s].
    """

    emergency_stop: bool = False
    stop: bool = False
    power: bool | None = None
    settings: tuple[Command, ...] = ()
    accelerations: Accelerations | None = None
    velocity: Twist2 | None = None

    def commands(self) -> list[Command]:
        """Return the commands to send, in this order."""
        out: list[Command] = []
        if self.stop:
            out.append(commands.Stop())
        if self.emergency_stop:
            out.append(commands.EStop())
        out += self.settings
        if self.accelerations is not None:
            out += _acceleration_commands(self.accelerations)
        if self.power is not None:
            out.append(commands.Enable(on=self.power))
        if self.velocity is not None:
            out += (commands.Vel(speed=self.velocity.v), commands.RVel(rate=self.velocity.w))
        return out


class Pilot:
    """Turns velocity commands into ARCOS commands, over all sessions with one robot.

    Attributes:
        deadline: When :meth:`tick` must next be called [s, monotonic, as every `now`].
        limits: Bounds of the present robot, or `None` before the first session.
        emergency: Whether the emergency stop is latched.
        auto_enable: Whether a command switches the motors on.
        last_stop: The stop that a command must have begun after.
    """

    def __init__(self, *, auto_enable: bool = True) -> None:
        self.deadline = inf
        self.limits: Limits | None = None
        self.emergency = False
        self.auto_enable = auto_enable
        self.last_stop = Stop()
        self._outbox = Outbox()
        self._snapshot: Snapshot | None = None
        self._command = VelocityCommand(STILL, -inf, after=0)
        self._awake_at = -inf
        self._sent: Twist2 | None = None
        self._sent_at = self._stopped_at = self._paced_until = -inf
        self._blocked: str | None = None
        self._escaped: Stop | None = None
        self._escapes_until = -inf
        self._sent_accelerations: Accelerations | None = None
        self._hands_off = False
        self._motors_wanted: bool | None = None
        self._motors_wanted_at = -inf
        self._motors_seen = False
        self._enable_tries = 0
        self._enabled: bool | None = None
        self._enabled_at = self._observed_at = -inf

    def session_opened(
        self,
        limits: Limits,
        now: float,
        *,
        settable_speed: bool = True,
        settable_acceleration: bool = True,
    ) -> None:
        """Set the robot up as far as its firmware lets us: limits, sonar on, everything still."""
        self.limits = limits
        settings: list[Command] = []
        if settable_speed:
            settings += [
                commands.SetV(speed=limits.max_speed),
                commands.SetRV(rate=limits.max_turn_rate),
            ]
        self._sent_accelerations = None
        if settable_acceleration:
            settings += _acceleration_commands(limits.accelerations)
            self._sent_accelerations = limits.accelerations
        settings.append(commands.Sonar(on=True))
        self._outbox = Outbox(stop=True, settings=tuple(settings))
        self._count_stop(self.last_stop.why)  # what was pressed meanwhile is no answer to the loss
        self._sent, self._sent_at, self._awake_at = STILL, -inf, now
        self.deadline = now + REPEAT

    def session_lost(self, why: str, now: float) -> None:
        """Forget what was asked: nothing of it may reach the next session."""
        self._outbox = Outbox()
        self._snapshot, self._sent, self._hands_off = None, None, False
        self._motors_wanted, self._motors_seen, self._enable_tries = None, False, 0
        self.deadline = inf
        self._block(f"the link was lost ({why})", now)

    def drive(self, command: VelocityCommand, now: float) -> str | None:
        """Obey `command` from `now` [s] until it expires; return why it is ignored, or `None`."""
        if self.limits is None:
            return "no robot is connected"
        if self.emergency:
            return LATCHED
        if self._snapshot is None:
            return self.last_stop.told if self._blocked else "no robot is connected"
        twist, stalled = command.twist, self.last_stop.stalled
        is_answer = command.answers_stall and stalled is not None
        if command.after < self.last_stop.number and not is_answer:
            return self.last_stop.told
        self._blocked, self._hands_off = None, False
        if stalled is not None and self._escaped != self.last_stop and leads_away(twist, stalled):
            self._escaped, self._escapes_until = self.last_stop, now + ESCAPE
        if self.enable_failed and self.asked(now).is_zero:
            self._motors_wanted = None  # who asks anew tries the motors anew
        self._command = replace(command, until=min(now + self.limits.expiry, command.until))
        if not twist.is_zero and self.auto_enable and not self._motors_wanted:
            self._want_motors(on=True, now=now)
        self._steer(now)
        return None

    def stop(self, now: float) -> None:
        """Stand still, at the set deceleration."""
        self._forget_command()
        self._hands_off = False
        if self._snapshot is None:
            self._count_stop(self.last_stop.why)
        else:
            self._blocked = None
            self._count_stop(STOPPED)
        self._outbox.velocity = None
        if self._sent != STILL or now >= self._stopped_at + PACE:
            self._outbox.stop, self._stopped_at = True, now
        self._sent, self._sent_at = STILL, now

    def emergency_stop(self, now: float) -> None:
        """Stop as hard as the robot can, motors off, until :meth:`reset_emergency_stop`."""
        self.stop(now)
        self._outbox.emergency_stop |= self._outbox.stop or not self.emergency
        self.emergency = True
        self._block("the emergency stop was pressed", now)
        self._want_motors(on=False, now=now)

    def reset_emergency_stop(self) -> None:
        """Release the latch; the motors stay off until asked for."""
        if self.emergency:
            self.emergency = False
            self._count_stop(self.last_stop.why)

    def hands_off(self, now: float) -> None:
        """Leave motion to somebody else until :meth:`stop` or a fresh request."""
        self._block("a raw command drives the robot", now)
        self._hands_off, self._sent = True, None

    def set_motors(self, *, on: bool, now: float) -> str | None:
        """Ask for power on the motors, or none once it stands; return why not, or `None`."""
        if on and self.emergency:
            return LATCHED
        stood = self.stands
        self.stop(now)
        self._want_motors(on=on, now=-inf if stood else now)
        self._power(now)
        return None

    def observe(self, snapshot: Snapshot, now: float) -> None:
        """Take in what the robot says, and act on it."""
        motors, before = snapshot.motors, self._snapshot
        self._snapshot, self._observed_at = snapshot, now
        self._notice_sleep(now)
        if motors.stop_button:
            if self._motors_wanted:
                self._motors_wanted = None  # released, it does not bring them back
            self._block("the stop button on the robot is pressed", now)
        elif motors.stalled and self._gives_in(now):
            self._block(STALLED, now, stalled=self._command.twist)
        elif self._motors_seen and not motors.enabled and self._motors_wanted:
            self._motors_wanted = None
            self._block("the robot switched its motors off", now)
        if not motors.stalled:
            self._escapes_until = -inf
        self._motors_seen = motors.enabled
        if motors.enabled:
            self._enable_tries = 0
        if before is None and self._motors_wanted is None:
            self._want_motors(on=False, now=-inf if self._rests else now)
        self._power(now)
        self._steer(now)

    def tick(self, now: float) -> None:
        """Let requests expire."""
        self._notice_sleep(now)
        self.deadline = now + REPEAT
        self._steer(now)

    def outgoing(self) -> list[Command]:
        """Return and forget the commands to send."""
        outbox, self._outbox = self._outbox, Outbox()
        return outbox.commands()

    @property
    def blocked(self) -> str | None:
        """Why requests are ignored until a fresh one, or `None`."""
        return self._blocked

    def asked(self, now: float) -> Twist2:
        """Return what the robot is asked to do at this moment, before limits."""
        return self._command.twist if now < self._command.until else STILL

    @property
    def sent(self) -> Twist2 | None:
        """What the robot was last told to do [m/s, rad/s]; `None` while others tell it."""
        return self._sent

    @property
    def stands(self) -> bool:
        """Whether the robot was told to stand, and does; or has no power to brake with."""
        if self._snapshot is None or not self._snapshot.motors.enabled:
            return True
        return self._sent == STILL and self._rests and self._observed_at > self._sent_at

    @property
    def expired(self) -> bool:
        """Whether the last thing asked for was motion (that may have expired since)."""
        return not self._command.twist.is_zero

    @property
    def enable_failed(self) -> bool:
        """Whether the motors were asked for and did not come on."""
        return bool(self._motors_wanted) and self._enable_tries >= ENABLE_TRIES

    def _notice_sleep(self, now: float) -> None:
        away, self._awake_at = now - self._awake_at, now
        if away > OVERSLEPT and self._snapshot is not None:
            self._block(f"the watchdog stopped the robot: this program slept {away:.1f} s", now)

    def _gives_in(self, now: float) -> bool:
        """Return whether wheels that are stalled now end what is asked for."""
        command = self._command
        return not (command.twist.is_zero or command.answers_stall or now < self._escapes_until)

    def _block(self, why: str, now: float, *, stalled: Twist2 | None = None) -> None:
        self._blocked = why
        self._count_stop(why, stalled)
        self._forget_command()

    def _forget_command(self) -> None:
        self._command = VelocityCommand(STILL, -inf, after=self.last_stop.number)

    def _count_stop(self, why: str, stalled: Twist2 | None = None) -> None:
        self.last_stop = Stop(self.last_stop.number + 1, why, stalled)

    def _want_motors(self, *, on: bool, now: float) -> None:
        """Want power on the motors; off from `now` on, once the robot stands."""
        self._motors_wanted, self._motors_wanted_at = on, now
        self._enable_tries = 0

    @property
    def _rests(self) -> bool:
        """Whether the robot stood when it last spoke."""
        if self._snapshot is None:
            return False
        measured = self._snapshot.odometry.twist
        return abs(measured.v) < STANDING.v and abs(measured.w) < STANDING.w

    def _power(self, now: float) -> None:
        """Bring the motors to the state wanted, as far as the robot plays along."""
        if self._snapshot is None or self._motors_wanted is None:
            return
        wanted = self._motors_wanted
        if wanted == self._snapshot.motors.enabled:
            if not wanted and not self.emergency:
                self._motors_wanted = None  # seen off; somebody at the robot may turn them on
            return
        if wanted and (self._snapshot.motors.stop_button or self.enable_failed):
            return
        if not wanted and self._brakes(now):
            return
        again = ENABLE_RETRY if wanted == self._enabled else PACE
        if now >= self._enabled_at + again:
            self._enabled, self._enabled_at = wanted, now
            self._enable_tries += 1
            self._outbox.power = wanted

    def _brakes(self, now: float) -> bool:
        """Return whether motors that shall go off are still needed to stop the robot."""
        return not (self.emergency or self.stands) and now < self._motors_wanted_at + BRAKING

    def _steer(self, now: float) -> None:
        """Send the velocity that is due."""
        snapshot, limits = self._snapshot, self.limits
        if snapshot is None or limits is None or self._hands_off:
            return
        self._power(now)
        self._set_accelerations(limits)
        blind = now - self._observed_at > BLIND
        twist = STILL if blind else limit(self.asked(now), limits, snapshot.bumpers)
        due = now >= self._sent_at + REPEAT and not (twist.is_zero and self._rests)
        change_at = self._paced_until - (BURST - 1) * PACE
        changed = twist != self._sent and (twist.is_zero or now >= change_at)
        if changed and not twist.is_zero:
            self._paced_until = max(self._paced_until, now) + PACE
        if changed or due:
            self._outbox.velocity = twist
            self._sent, self._sent_at = twist, now
        again = self._sent_at + REPEAT if twist == self._sent else change_at
        power_at = inf if self._motors_wanted else self._motors_wanted_at + BRAKING
        due_at = (again, self._command.until, power_at, now + REPEAT)
        self.deadline = min(due for due in due_at if due > now)

    def _set_accelerations(self, limits: Limits) -> None:
        """Send the accelerations that are wanted, where the robot takes any and they are new."""
        wanted = self._command.accelerations or limits.accelerations
        if self._sent_accelerations is not None and wanted != self._sent_accelerations:
            self._outbox.accelerations = self._sent_accelerations = wanted


def _acceleration_commands(accelerations: Accelerations) -> list[Command]:
    return [
        commands.SetA(acceleration=accelerations.acceleration),
        commands.SetA(acceleration=-accelerations.deceleration),
        commands.SetRA(acceleration=accelerations.turn_acceleration),
        commands.SetRA(acceleration=-accelerations.turn_deceleration),
    ]
