"""Which commands the robot gets, and when. No I/O: requests, snapshots and the time come in.

Rules:

1. A request expires. Then, and on every doubt, the robot is told to stand still.
2. VEL and RVEL are repeated while the robot moves or should: a lost frame costs 0.2 s at most.
3. Motors go on when a request needs them, and only then; seen in the snapshots, and retried.
4. After a lost link, a stall, either stop button or motors that went off by themselves, requests
   are ignored until there is a *fresh* one: after a pause of :attr:`Limits.expiry`, a zero that
   somebody asks for anew, :meth:`Pilot.stop`, or :meth:`Pilot.set_motors`. A key that was held all
   the time is not fresh, nor is a behavior that waits.
   The one exception: a request that is the answer to a stall (:class:`StallRecover`) goes on.
5. The emergency stop latches. Resetting it leaves the motors off.
"""

from math import inf

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.geometry import STILL, Twist2
from pioneer3.limits import Limits, Pace
from pioneer3.robot.limits import limit
from pioneer3.state import Snapshot

REPEAT = 0.2
"""Pause between repetitions of a velocity [s]."""
PACE = 0.05
"""Shortest pause between two velocities [s]: both frames take 19 ms at 9600 baud. A stop never
waits."""
ENABLE_RETRY = 0.5
ENABLE_TRIES = 4
STANDING = Twist2(0.005, 0.01)
"""Slower than this counts as standing [m/s, rad/s]."""
STALLED = "the wheels stalled"
LATCHED = "the emergency stop is latched"
OVERSLEPT = 2.0
"""A host that was away for this long [s] finds that the robot's watchdog has stopped it."""


class Pilot:
    """Turns requests into commands, over all sessions with one robot.

    Attributes:
        deadline: When :meth:`tick` must next be called [s, monotonic, as every `now`].
        limits: Bounds of the present robot, or `None` before the first session.
        emergency: Whether the emergency stop is latched.
        auto_enable: Whether a fresh command switches the motors on.
    """

    def __init__(self, *, auto_enable: bool = True) -> None:
        self.deadline = inf
        self.limits: Limits | None = None
        self.emergency = False
        self.auto_enable = auto_enable
        self._outbox: list[Command] = []
        self._snapshot: Snapshot | None = None
        self._request = STILL
        self._until = self._requested_at = self._awake_at = -inf
        self._sent: Twist2 | None = None
        self._sent_at = -inf
        self._blocked: str | None = None
        self._despite_stall = False
        self._pace: Pace | None = None
        self._sent_pace: Pace | None = None
        self._hands_off = False
        self._motors_wanted: bool | None = None
        self._motors_seen = False
        self._enable_tries = 0
        self._enabled_at = -inf

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
        self._outbox = [commands.Stop()]
        if settable_speed:
            self._outbox += [
                commands.SetV(speed=limits.max_speed),
                commands.SetRV(rate=limits.max_turn_rate),
            ]
        self._pace, self._sent_pace = None, None
        if settable_acceleration:
            self._outbox += _paces(limits.pace)
            self._sent_pace = limits.pace
        self._outbox.append(commands.Sonar(on=True))
        self._sent, self._sent_at, self._awake_at = STILL, -inf, now
        self.deadline = now + REPEAT

    def session_lost(self, why: str, now: float) -> None:
        """Forget what was asked: nothing of it may reach the next session."""
        self._outbox.clear()
        self._snapshot, self._sent, self._hands_off = None, None, False
        self._motors_wanted, self._motors_seen, self._enable_tries = None, False, 0
        self.deadline = inf
        self._block(f"the link was lost ({why}); let go, then ask again", now)

    def drive(
        self,
        twist: Twist2,
        now: float,
        until: float = inf,
        *,
        renewed: bool = False,
        despite_stall: bool = False,
        pace: Pace | None = None,
    ) -> str | None:
        """Ask for `twist` until it expires, at `until` [s] at the latest.

        What is `renewed` was asked for before, and is never fresh. `pace` is how to get there, the
        robot's own if `None`. Returns why it is ignored, or `None`.
        """
        if self.limits is None:
            return "no robot is connected"
        expiry = self.limits.expiry
        fresh = not renewed and (twist.is_zero or now - self._requested_at > expiry)
        if not twist.is_zero:
            self._requested_at = min(now, until - expiry)
        elif not renewed:
            self._requested_at = -inf
        if self.emergency:
            return LATCHED
        answered = despite_stall and self._blocked == STALLED
        if self._blocked and (fresh or answered) and self._snapshot is not None:
            self._blocked, self._hands_off = None, False
        if self._blocked:
            return self._blocked
        if self._snapshot is None:
            return "no robot is connected"
        self._request, self._until = twist, min(now + expiry, until)
        self._despite_stall, self._pace = despite_stall, pace
        given_up = fresh and self.enable_failed
        if not twist.is_zero and self.auto_enable and (given_up or not self._motors_wanted):
            self._want_motors(on=True)
        self._steer(now)
        return None

    def stop(self, now: float) -> None:
        """Stand still, at the set deceleration."""
        self._request, self._until, self._requested_at = STILL, now, -inf
        self._despite_stall, self._pace, self._hands_off = False, None, False
        if self._snapshot is not None:
            self._blocked = None
        self._sent, self._sent_at = STILL, now
        self._outbox.append(commands.Stop())

    def emergency_stop(self, now: float) -> None:
        """Stop as hard as the robot can, motors off, until :meth:`reset_emergency_stop`."""
        self.stop(now)
        self.emergency = True
        self._block("the emergency stop was pressed; let go, then ask again", now)
        self._outbox.append(commands.EStop())
        self._want_motors(on=False)

    def reset_emergency_stop(self) -> None:
        """Release the latch; the motors stay off until asked for."""
        self.emergency = False

    def hands_off(self, now: float) -> None:
        """Leave motion to somebody else until :meth:`stop` or a fresh request."""
        self._block("a raw command drives the robot; stop it, or let go, then ask again", now)
        self._hands_off, self._sent = True, None

    def set_motors(self, *, on: bool, now: float) -> str | None:
        """Ask for power on the motors, or none; return why not, or `None`."""
        if on and self.emergency:
            return LATCHED
        self.stop(now)
        self._want_motors(on=on)
        self._power(now)
        return None

    def observe(self, snapshot: Snapshot, now: float) -> None:
        """Take in what the robot says, and act on it."""
        motors, before = snapshot.motors, self._snapshot
        self._snapshot = snapshot
        self._notice_sleep(now)
        if motors.stop_button:
            if self._motors_wanted:
                self._motors_wanted = None  # released, it does not bring them back
            self._block("the stop button on the robot is pressed", now)
        elif motors.stalled and not self._request.is_zero and not self._despite_stall:
            self._block(STALLED, now)
        elif self._motors_seen and not motors.enabled and self._motors_wanted:
            self._motors_wanted = None
            self._block("the robot switched its motors off", now)
        self._motors_seen = motors.enabled
        if motors.enabled:
            self._enable_tries = 0
        if before is None and self._motors_wanted is None:
            self._want_motors(on=False)
        self._power(now)
        self._steer(now)

    def tick(self, now: float) -> None:
        """Let requests expire."""
        self._notice_sleep(now)
        self.deadline = now + REPEAT
        self._steer(now)

    def outgoing(self) -> list[Command]:
        """Return and forget the commands to send."""
        outbox, self._outbox = self._outbox, []
        return outbox

    @property
    def blocked(self) -> str | None:
        """Why requests are ignored until a fresh one, or `None`."""
        return self._blocked

    def refusal(self, *, despite_stall: bool = False) -> str | None:
        """Return why what goes on by itself must end, or `None`; it may answer a stall."""
        if self.emergency:
            return LATCHED
        return None if despite_stall and self._blocked == STALLED else self._blocked

    def asked(self, now: float) -> Twist2:
        """Return what the robot is asked to do at this moment, before limits."""
        return self._request if now < self._until else STILL

    @property
    def sent(self) -> Twist2 | None:
        """What the robot was last told to do [m/s, rad/s]; `None` while others tell it."""
        return self._sent

    @property
    def expired(self) -> bool:
        """Whether the last thing asked for was motion (that may have expired since)."""
        return not self._request.is_zero

    @property
    def enable_failed(self) -> bool:
        """Whether the motors were asked for and did not come on."""
        return bool(self._motors_wanted) and self._enable_tries >= ENABLE_TRIES

    def _notice_sleep(self, now: float) -> None:
        away, self._awake_at = now - self._awake_at, now
        if away > OVERSLEPT and self._snapshot is not None:
            self._block(f"the watchdog stopped the robot: this program slept {away:.1f} s", now)

    def _block(self, why: str, now: float) -> None:
        self._blocked = why
        self._request, self._until, self._requested_at = STILL, now, now
        self._despite_stall, self._pace = False, None

    def _want_motors(self, *, on: bool) -> None:
        self._motors_wanted, self._enable_tries, self._enabled_at = on, 0, -inf

    def _power(self, now: float) -> None:
        """Bring the motors to the state wanted, as far as the robot plays along."""
        if self._snapshot is None or self._motors_wanted is None:
            return
        if self._motors_wanted == self._snapshot.motors.enabled:
            if not self._motors_wanted and not self.emergency:
                self._motors_wanted = None  # seen off; somebody at the robot may turn them on
            return
        if self._motors_wanted and (self._snapshot.motors.stop_button or self.enable_failed):
            return
        if now - self._enabled_at >= ENABLE_RETRY:
            self._enabled_at = now
            self._enable_tries += 1
            self._outbox.append(commands.Enable(on=bool(self._motors_wanted)))

    def _steer(self, now: float) -> None:
        """Send the velocity that is due."""
        snapshot, limits = self._snapshot, self.limits
        if snapshot is None or limits is None or self._hands_off:
            return
        self._power(now)
        twist = limit(self.asked(now), limits, snapshot.bumpers)
        measured = snapshot.odometry.twist
        rests = abs(measured.v) < STANDING.v and abs(measured.w) < STANDING.w
        due = now >= self._sent_at + REPEAT and not (twist.is_zero and rests)
        changed = twist != self._sent and (twist.is_zero or now >= self._sent_at + PACE)
        if changed or due:
            self._set_pace(limits)
            self._outbox += (commands.Vel(speed=twist.v), commands.RVel(rate=twist.w))
            self._sent, self._sent_at = twist, now
        again = self._sent_at + (REPEAT if twist == self._sent else PACE)
        self.deadline = min(
            again if again > now else now + REPEAT, self._until if self._until > now else inf
        )

    def _set_pace(self, limits: Limits) -> None:
        """Send the accelerations that are wanted, where the robot takes any and they are new."""
        wanted = self._pace or limits.pace
        if self._sent_pace is not None and wanted != self._sent_pace:
            self._outbox += _paces(wanted)
            self._sent_pace = wanted


def _paces(pace: Pace) -> list[Command]:
    return [
        commands.SetA(acceleration=pace.acceleration),
        commands.SetA(acceleration=-pace.deceleration),
        commands.SetRA(acceleration=pace.turn_acceleration),
        commands.SetRA(acceleration=-pace.turn_deceleration),
    ]
