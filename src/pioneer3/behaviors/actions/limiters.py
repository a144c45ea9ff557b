"""Actions that limit the speed by the room there is."""

from dataclasses import dataclass, field, replace
from itertools import chain
from math import atan2, hypot, inf, radians, sqrt

from pioneer3.behaviors.action import Action, Desire, Situation
from pioneer3.behaviors.actions.sensing import BLIND, ahead, behind, blind_behind, table_seen
from pioneer3.behaviors.pings import Ping, PingReader
from pioneer3.behaviors.surroundings import Buffer, Point
from pioneer3.geometry import TURN, Pose2, wrap
from pioneer3.models import RobotModel

CREEP = 0.035
"""Touching something at this speed does no harm [m/s]; a robot with a bad view may go on at it."""


@dataclass(slots=True)
class LimiterForwards(Action):
    """Limits the speed forwards by obstacles ahead within the robot's width (facts.md 7.6).

    Attributes:
        stop_distance: Nearer than this to the robot's front it may not go [m].
        slow_distance: Farther than this it may go at any speed [m].
        slow_speed: At `slow_distance` [m/s]; from there down to 0 at `stop_distance`.
        width_ratio: Width looked at over the robot's.
    """

    stop_distance: float = 0.25
    slow_distance: float = 1.0
    slow_speed: float = 0.2
    width_ratio: float = 1.0
    name: str = "limiter forwards"

    def decide(self, situation: Situation) -> Desire | None:
        """Return the limit; without range sensors, no motion."""
        if not situation.around.sensing:
            return Desire(v_max=0.0, lacks=True, reason=BLIND)
        model = situation.model
        side, front = model.width / 2 * self.width_ratio, model.length / 2
        reach = max(self.stop_distance, self.slow_distance) + front
        echo = situation.around.nearest_in_box(0.0, -side, reach, side, Buffer.WINDOW)
        distance = echo.distance - front
        if distance > self.slow_distance:
            return None
        share = _share(distance, self.stop_distance, self.slow_distance)
        return Desire(v_max=self.slow_speed * share, reason=ahead(distance, echo))


@dataclass(slots=True)
class LimiterBackwards(Action):
    """Limits the speed backwards by obstacles behind within one and a half widths (facts.md 7.6).

    Distances are positive here. It looks as far as `slow_distance`; ARIA's box ends at
    `stop_distance` behind the robot, so that it slows down for nothing farther away.

    Attributes:
        stop_distance: Nearer than this to the robot's circle it may not go [m].
        slow_distance: Farther than this it may go at `max_speed` [m].
        max_speed: [m/s], even when nothing is seen; down to 0 at `stop_distance`.
        width_ratio: Width looked at over the robot's.
    """

    stop_distance: float = 0.25
    slow_distance: float = 0.6
    max_speed: float = 0.25
    width_ratio: float = 1.5
    name: str = "limiter backwards"

    def decide(self, situation: Situation) -> Desire:
        """Return the limit; without range sensors no motion, where none looks behind a creep."""
        if not situation.around.sensing:
            return Desire(back_max=0.0, lacks=True, reason=BLIND)
        if blind := blind_behind(situation):
            return Desire(back_max=CREEP, reason=blind)
        model = situation.model
        side = model.width / 2 * self.width_ratio
        reach = max(self.stop_distance, self.slow_distance) + max(model.length, model.radius)
        echo = situation.around.nearest_in_box(0.0, -side, -reach, side, Buffer.WINDOW)
        distance = echo.distance - model.radius
        if distance > self.slow_distance:
            return Desire(back_max=self.max_speed, reason="nothing behind")
        share = _share(distance, self.stop_distance, self.slow_distance)
        return Desire(back_max=self.max_speed * share, reason=behind(distance))


@dataclass(slots=True)
class LimiterTableSensor(Action):
    """Keeps the robot from driving under a table (facts.md 7.6)."""

    name: str = "limiter table sensor"

    def decide(self, situation: Situation) -> Desire | None:
        """Return no speed forwards while a table is seen."""
        table = table_seen(situation)
        return Desire(v_max=0.0, reason=str(table)) if table else None


def _share(distance: float, stop: float, slow: float) -> float:
    """Return how far between the two `distance` is, 0 to 1."""
    return 0.0 if distance < stop or slow <= stop else (distance - stop) / (slow - stop)


BY_SONAR = 0.4
"""Wandering at this speed [m/s] by sonars alone touches nothing (docs/explanation/safety.md)."""


@dataclass(slots=True)
class LimiterBySonar(Action):
    """Slows a mode down while a laser that should scan does not: sonars see less, and later.

    Not one of ARIA's.
    """

    speed: float = BY_SONAR
    name: str = "limiter by sonar"

    def decide(self, situation: Situation) -> Desire | None:
        """Return the limit, and which laser is lost."""
        if not situation.lost_lasers:
            return None
        lost = "; ".join(situation.lost_lasers)
        return Desire(v_max=self.speed, back_max=self.speed, reason=f"{lost}: goes by sonar")


UNSURE = radians(20)
"""How far off its axis a sonar's echo may come from, and what wheels that slip make of a turn."""
SLOWEST_CORNER = 0.01
"""Speed of its corners up to which a robot that drives may always turn [m/s]."""
AWAY_SPEED = 0.035
"""Speed of a corner that turns away from an echo, as long as that may come from the other side
[m/s]."""


@dataclass(slots=True)
class LimiterSweep(Action):
    """Slows the robot down before obstacles that it sees or has seen; never below a creep.

    Not one of ARIA's, whose limiters look ahead only, at what is seen now: things that sonars have
    lost and corners of a turning robot are what it runs into. Because memory may be wrong, a robot
    may always go on forwards and turn at a creep, at which touching something does no harm. It may
    not creep backwards too: a corner that turns meanwhile moves nearly twice as fast. Where no
    sensor looks behind, a creep is the most backwards.

    Attributes:
        creep: Speed at which any point of the robot may meet something [m/s].
        margin: Kept before and behind the robot, and beside it on its way forwards [m].
        deceleration: This ends the speed in time, both ways [m/s^2].
        turn_time: It takes at least this long to turn until something is met [s].
    """

    creep: float = CREEP
    margin: float = 0.05
    deceleration: float = 0.3
    turn_time: float = 1.2
    name: str = "limiter sweep"

    def decide(self, situation: Situation) -> Desire | None:
        """Return limits of the speed both ways and of both turns, or `None`."""
        model, around = situation.model, situation.around
        corner = model.corner
        side, reach = model.width / 2 + self.margin, corner + self.margin
        half, rear = model.width / 2, -model.length_rear
        front, back, left, right = inf, inf, inf, inf
        for point in chain(around.points(Buffer.WINDOW), around.points(Buffer.CUMULATIVE)):
            x, y, distance, _ = point
            if 0 < x < front and -side < y < side:
                front = x
            elif -back < x < rear and -half < y < half:  # beside a rear corner is not behind it
                back = -x
            if distance < reach:
                to_left, to_right = self._turns_to(point, model)
                left, right = min(left, to_left), min(right, to_right)
        front, back = front - model.length_front, back - model.length_rear
        top = situation.limits.max_speed
        v_max, back_max = self._fastest(front, top, self.creep), self._fastest(back, top, 0.0)
        why_back, blind = behind(back), blind_behind(situation)
        if blind and (back_max is None or back_max > self.creep):
            why_back, back_max = blind, self.creep
        if v_max is None and back_max is None and left == right == inf:
            return None
        if v_max is not None:
            reason = f"{front:.2f} m ahead"
        else:
            reason = "a corner is near something" if back_max is None else why_back
        return Desire(
            v_max=v_max,
            back_max=back_max,
            left_max=self._rate(left, corner, situation.twist.v),
            right_max=self._rate(right, corner, situation.twist.v),
            reason=reason,
        )

    def _fastest(self, gap: float, top: float, least: float) -> float | None:
        """Return the speed that ends within `gap` [m], or `None` if it is above `top` [m/s]."""
        fastest = sqrt(2 * self.deceleration * max(0.0, gap - self.margin))
        return max(least, fastest) if fastest < top else None

    def _rate(self, angle: float, corner: float, v: float) -> float | None:
        """Return the turn rate that may meet something `angle` ahead of a corner, at speed `v`.

        What a robot drives adds to the speed of its corners: the creep is of both together.
        """
        if angle == inf:
            return None
        least = max(min(SLOWEST_CORNER, self.creep), self.creep - abs(v)) / corner
        return max(least, angle / self.turn_time)

    def _turns_to(self, point: Point, model: RobotModel) -> tuple[float, float]:
        """Return how far [rad] the robot can turn left, and right, until it meets `point`."""
        left = right = inf
        for x in (model.length_front, -model.length_rear):
            for y in (model.width / 2, -model.width / 2):
                corner = hypot(x, y)
                if point.distance < corner + self.margin:
                    between = wrap(point.bearing - atan2(y, x))
                    away = self.turn_time * AWAY_SPEED / corner
                    left = min(left, _turn_to(between, away))
                    right = min(right, _turn_to(-between, away))
        return left, right


def _turn_to(between: float, away: float) -> float:
    """Return how far a corner turns until it meets a point `between` [rad] ahead of it.

    Of a point a little behind it, which may be ahead of it in truth, return `away`.
    """
    if -UNSURE < between < 0:
        return away
    return max(0.0, between % TURN - UNSURE)


FRESH_ECHO = 0.7
"""Age above which echoes do not count [s]: two turns of a ring."""
BRAKE_DELAY = 0.25
"""Until the robot begins to brake: the turn of a ring, in the mean, and a report [s]."""
PLANNED_SHARE = 0.7
"""Share of the deceleration that is planned with."""


@dataclass(slots=True, kw_only=True)
class Brake(Action):
    """Limits the speed forwards so that the robot can brake in time.

    Where the other limiters keep clear of all that has been heard in the last seconds, and so of
    where a person ahead has just walked, this one knows only what each transducer heard last.
    With distance d to the obstacle ahead, less `clearance`, speed v is allowed where
    v `BRAKE_DELAY` + v^2 / (2 `PLANNED_SHARE` deceleration) <= d. It lets the robot come as near
    as `clearance`.

    Attributes:
        clearance: To be kept between the front end and an obstacle [m].
        beside: To be kept on either side of the robot [m].
    """

    clearance: float = 0.1
    beside: float = 0.08
    name: str = "brake"
    _listener: PingReader = field(default_factory=PingReader, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the limit, if anything is ahead; without sonars, no motion forwards."""
        self._listener.listen(situation)
        latest = self._listener.latest.values()
        recent = [ping for ping in latest if situation.now - ping.stamp <= FRESH_ECHO]
        if not recent:
            return Desire(v_max=0.0, lacks=True, reason=BLIND)
        gap = min(_gap(ping, situation, self.beside) for ping in recent)
        if gap == inf:
            return None
        top = stopping_speed(gap - self.clearance, situation.limits.deceleration)
        if top >= situation.limits.max_speed:
            return None
        return Desire(v_max=top, reason=f"{gap:.2f} m ahead")


def stopping_speed(distance: float, deceleration: float) -> float:
    """Return the speed from which a robot comes to stand within `distance` [m]."""
    a = PLANNED_SHARE * deceleration
    return a * (sqrt(BRAKE_DELAY**2 + 2 * max(distance, 0.0) / a) - BRAKE_DELAY)


def _gap(ping: Ping, situation: Situation, beside: float) -> float:
    """Return how far ahead of the front end an echo is; `inf` if it is not in the way."""
    if ping.distance == inf:
        return inf
    there, model = situation.pose.inverse() @ Pose2(*ping.point), situation.model
    inside = there.x > 0 and abs(there.y) <= model.width / 2 + beside
    return max(0.0, there.x - model.length_front) if inside else inf


FAR = 16.0
"""How far beyond the padding it looks [m]."""
OTHER_WAY = 0.1
"""Faster than this [m/s] the other way it is not asked."""
INSIDE = 0.001
"""Room below which an obstacle is within the padding [m]."""
ROLLING_SPEED = 0.005
"""Speed up to which a robot does not roll [m/s]."""
FAST_SPEED = 0.1
"""Speed above which a robot brakes harder for what is too near [m/s]."""
TOP_DECELERATION = 2.0
"""Deceleration that no Pioneer brakes harder with [m/s^2] (protocol.md 5.1)."""


@dataclass(slots=True, kw_only=True)
class DeceleratingLimiter(Action):
    """Limits the speed one way so that the robot can stop before an obstacle (facts.md 7.6).

    The room it keeps grows with the speed. Outside of it the speed may be as high as
    `preferred_decel` can end in time, `reaction` after it was seen. ARIA says speed 0 at that
    distance and lets the deceleration make the curve, with no time to react. Our driver brakes
    harder than ARIA's by itself: the robot would stop and start over and over on its way, and from
    rest it might speed up at any distance.

    Attributes:
        backwards: Which way.
        clearance: Kept in any case ahead of the robot [m].
        side_clearance_at_slow_speed: Kept beside it [m].
        padding_at_slow_speed: Kept ahead beyond `clearance` [m].
        slow_speed: At and below it the former of two hold [m/s]; between the speeds, in proportion.
        fast_speed: At and above it the latter hold [m/s].
        reaction: From an echo until the robot obeys [s]: a report's cycle and 0.3 s each way, as
            over a bad radio link.
        emergency_decel: When something is nearer than `clearance` [m/s^2]; 0 for the robot's own.
        creep: The most backwards where no sensor looks [m/s].
    """

    backwards: bool = False
    clearance: float = 0.1
    side_clearance_at_slow_speed: float = 0.05
    side_clearance_at_fast_speed: float = 0.4
    padding_at_slow_speed: float = 0.05
    padding_at_fast_speed: float = 0.3
    slow_speed: float = 0.2
    fast_speed: float = 1.0
    preferred_decel: float = 0.6
    reaction: float = 0.7
    emergency_decel: float = 0.0
    creep: float = CREEP
    name: str = ""

    def __post_init__(self) -> None:
        if not self.name:
            self.name = f"decelerating limiter {'backwards' if self.backwards else 'forwards'}"

    def decide(self, situation: Situation) -> Desire | None:
        """Return the limit; without range sensors, no motion."""
        v = -situation.twist.v if self.backwards else situation.twist.v
        if v < -OTHER_WAY:
            return None
        if not situation.around.sensing:
            return replace(self._limit(0.0, BLIND), lacks=True)
        share = min(1.0, max(0.0, (abs(v) - self.slow_speed) / (self.fast_speed - self.slow_speed)))
        side = _between(share, self.side_clearance_at_slow_speed, self.side_clearance_at_fast_speed)
        padding = _between(share, self.padding_at_slow_speed, self.padding_at_fast_speed)
        inside, reason = self._room(situation, self.side_clearance_at_slow_speed, 0.0)
        if inside < INSIDE:
            return self._too_near(v, situation.limits.deceleration, reason)
        room, reason = self._room(situation, side, padding)
        fastest = self._fastest(max(0.0, room))
        blind = blind_behind(situation) if self.backwards else None
        if blind and fastest > self.creep:
            return self._limit(self.creep, blind)
        if fastest >= situation.limits.max_speed:
            return None
        return self._limit(fastest, reason, self._braking(v, room, inside, situation))

    def _fastest(self, room: float) -> float:
        """Return the speed [m/s] that ends within `room` [m]: v t + v^2 / (2 a) = room."""
        a, t = self.preferred_decel, self.reaction
        return a * (sqrt(t**2 + 2 * room / a) - t)

    def _room(self, situation: Situation, side: float, padding: float) -> tuple[float, str]:
        """Return how far one may go [m], and why not farther."""
        model, way = situation.model, -1 if self.backwards else 1
        taken = model.length / 2 + self.clearance + padding
        half = model.width / 2 + side
        echo = situation.around.nearest_in_box(0.0, -half, way * (taken + FAR), half, Buffer.WINDOW)
        edge = echo.distance - model.length / 2
        return echo.distance - taken, behind(edge) if self.backwards else ahead(edge, echo)

    def _too_near(self, v: float, own: float, reason: str) -> Desire:
        if abs(v) <= ROLLING_SPEED:
            return self._limit(0.0, reason)
        brake = (self.emergency_decel or own) if abs(v) > FAST_SPEED else None
        return self._limit(0.0, reason, brake, v=0.0)

    def _braking(self, v: float, room: float, inside: float, situation: Situation) -> float | None:
        """Return the deceleration needed beyond the robot's own [m/s^2], or `None`."""
        needed = v**2 / (2 * room) if room > 0 else inf
        if v <= ROLLING_SPEED or needed <= situation.limits.deceleration:
            return None
        if self.emergency_decel:
            return self.emergency_decel
        hard = v**2 / (2 * inside)
        return min(
            hard if hard > self.preferred_decel else min(needed, self.preferred_decel),
            TOP_DECELERATION,
        )

    def _limit(
        self, top: float, reason: str, brake: float | None = None, v: float | None = None
    ) -> Desire:
        if self.backwards:
            return Desire(back_max=top, deceleration=brake, v=v, reason=reason)
        return Desire(v_max=top, deceleration=brake, v=v, reason=reason)


def _between(share: float, slow: float, fast: float) -> float:
    return slow + share * (fast - slow)
