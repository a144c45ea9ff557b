"""The parts of a decision: situations, desires, actions, and stacks of actions."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from math import hypot, inf, isfinite
from operator import attrgetter
from typing import Protocol

from pioneer3.behaviors.surroundings import NOTHING_SENSED, Surroundings
from pioneer3.geometry import Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.state import Scan, Snapshot
from pioneer3.stops import NO_STOP, Stop


@dataclass(frozen=True, slots=True)
class Weighted:
    """A value and its strength: 1 leaves nothing to lower priorities, 0 asks for nothing."""

    value: float
    strength: float = 1.0

    def __post_init__(self) -> None:
        if not 0 <= self.strength <= 1:
            raise ValueError(f"strength must be 0 to 1, not {self.strength}")


Channel = float | Weighted | None
"""A value with its strength, a number with strength 1, or nothing."""

NO_STRENGTH = 1e-6
"""Weaker desires are none (facts.md 7.3)."""
MOTION = ("v", "turn", "w")
"""Channels that are mixed by strength."""
LOWEST = (
    "v_max",
    "back_max",
    "left_max",
    "right_max",
    "acceleration",
    "turn_acceleration",
)
"""Limits of which the lowest holds."""
HIGHEST = ("deceleration", "turn_deceleration")
"""Limits of which the highest holds: braking harder is the safer side."""
LIMITS = frozenset((*LOWEST, *HIGHEST))
CHANNELS = ("v", "turn", "heading", "w", *LOWEST, *HIGHEST)
_channels_of = attrgetter(*CHANNELS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Desire:
    """The motion that one action asks for; `None` leaves a channel to lower priorities.

    Limits hold whatever their strength, unless that is 0; the safest value wins.

    Attributes:
        v: Speed [m/s].
        turn: Turn from the present heading [rad], counter-clockwise positive.
        heading: Heading in odometry's frame to turn to [rad]; in place of `turn`.
        w: Turn rate [rad/s].
        v_max: Limit of the speed forwards [m/s].
        back_max: Limit of the speed backwards [m/s], positive.
        left_max: Limit of the turn rate counter-clockwise [rad/s].
        right_max: Limit of the turn rate clockwise [rad/s], positive.
        acceleration: Limit of speeding up [m/s^2].
        deceleration: Least deceleration to brake with [m/s^2].
        turn_acceleration: Limit of turning faster [rad/s^2].
        turn_deceleration: Least deceleration of turns [rad/s^2].
        until: When this ends [s, monotonic].
        answers_stall: Whether this is the answer to a stall, which ends every other motion.
        lacks: Whether it stands for want of what it must know: the `reason` says what. A mode that
            stands so for more than a moment ends.
        reason: Shown to people, in a few words: the cause, such as an echo.
    """

    v: Channel = None
    turn: Channel = None
    heading: Channel = None
    w: Channel = None
    v_max: Channel = None
    back_max: Channel = None
    left_max: Channel = None
    right_max: Channel = None
    acceleration: Channel = None
    deceleration: Channel = None
    turn_acceleration: Channel = None
    turn_deceleration: Channel = None
    until: float = inf
    answers_stall: bool = False
    lacks: bool = False
    reason: str = ""

    def __post_init__(self) -> None:
        if self.turn is not None and self.heading is not None:
            raise ValueError("wants a turn and a heading at once")
        for channel, asked in zip(CHANNELS, _channels_of(self), strict=True):
            if asked is None:
                continue
            value = asked.value if isinstance(asked, Weighted) else asked
            if not isfinite(value):
                raise ValueError(f"{channel} is {value}, which is no number to drive by")
            if value < 0 and channel in LIMITS:
                raise ValueError(f"{channel} must not be negative, as {value} is")


def as_weighted(channel: Channel) -> Weighted | None:
    """Return the value of a channel with its strength, or `None` if it asks for nothing."""
    if channel is None:
        return None
    weighted = channel if isinstance(channel, Weighted) else Weighted(channel)
    return weighted if weighted.strength > NO_STRENGTH else None


@dataclass(frozen=True, slots=True)
class Contribution:
    """The part of one action in a decision, on a channel of :class:`Desire` that is no heading.

    The `strength` is the one that counted: higher priorities took the rest.
    """

    action: str
    channel: str
    value: float
    strength: float
    reason: str
    lacks: bool = False


@dataclass(frozen=True, slots=True)
class Combined:
    """The desires of several actions, merged by priority.

    Attributes:
        motion: By channel (`v`, `turn`, `w`); a strength of 1 leaves nothing to lower priorities.
        limits: By channel, where an action has set one.
        until: When the first desire that counts in `motion` ends [s, monotonic].
        contributions: The parts of the actions, highest priority first.
    """

    motion: dict[str, Weighted] = field(default_factory=dict)
    limits: dict[str, float] = field(default_factory=dict)
    until: float = inf
    answers_stall: bool = False
    contributions: tuple[Contribution, ...] = ()

    def strength(self, channel: str) -> float:
        """Return how much of a motion channel is taken, 0 to 1."""
        taken = self.motion.get(channel)
        return taken.strength if taken else 0.0

    @property
    def owned(self) -> bool:
        """Whether any motion channel is fully taken."""
        return any(taken.strength >= 1 - NO_STRENGTH for taken in self.motion.values())


NOTHING_ASKED = Combined()


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """All that an action decides on, at one instant.

    Attributes:
        now: [s, monotonic].
        around: The obstacles that its sensors see and have seen.
        scan: The newest scan of its first laser; `None` if none has come for a while.
        lost_lasers: For each laser that should scan and does not, a sentence.
        last_stop: The last stop; a command by hand must have begun after it.
        higher: The desires of higher priorities.
    """

    now: float
    snapshot: Snapshot
    model: RobotModel
    limits: Limits
    around: Surroundings = NOTHING_SENSED
    scan: Scan | None = None
    lost_lasers: tuple[str, ...] = ()
    last_stop: Stop = NO_STOP
    higher: Combined = NOTHING_ASKED

    @property
    def pose(self) -> Pose2:
        """The robot's pose in odometry's frame [m, rad]."""
        return self.snapshot.odometry.robot_in_odom

    @property
    def twist(self) -> Twist2:
        """Its motion, as measured [m/s, rad/s]."""
        return self.snapshot.odometry.twist


MODE = 20
"""Priority of modes against other stacks: below every hand and program at the controls."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Goal:
    """A place in odometry's frame.

    Attributes:
        heading: To turn to there [rad], or `None`.
        person: Whether it is the place of a person who is followed.
        name: Of the place, on a map, or empty.
        to_go: Way that is left [m], where one is planned; its driver decides when to give up.
    """

    x: float
    y: float
    heading: float | None = None
    person: bool = False
    name: str = field(default="", compare=False)
    to_go: float | None = field(default=None, compare=False)


class Action(Protocol):
    """Turns a situation into a desire. Its priority is its place in a stack.

    Actions inherit from this, and say only what differs from these defaults.

    Attributes:
        name: Shown to people; unique in its stack.
    """

    __slots__ = ()
    name: str

    @property
    def done(self) -> bool:
        """Whether it has reached its aim, which ends the mode."""
        return False

    @property
    def failed(self) -> str | None:
        """The reason to give up, which ends the mode, or `None`."""
        return None

    @property
    def goal(self) -> Goal | None:
        """The place that it goes to, or `None`."""
        return None

    @property
    def wants_scans(self) -> bool:
        """Whether it looks at scans: lasers are on while its mode runs."""
        return False

    def decide(self, situation: Situation) -> Desire | None:
        """Return the desire at this instant, or `None`. Called once per snapshot."""


@dataclass(frozen=True, slots=True)
class Ranked:
    """An action at its place in a stack; the higher priority decides first."""

    priority: int
    action: Action

    def __post_init__(self) -> None:
        """Refuse an action without the defaults, before it takes part in driving."""
        if Action not in type(self.action).__mro__:
            name = type(self.action).__name__
            raise TypeError(f"{name} is no action: it must inherit from pioneer3.behaviors.Action")


@dataclass(frozen=True, slots=True)
class Stack:
    """Actions that drive together, the highest priority first.

    The stack's own priority is against other stacks.
    """

    name: str
    priority: int
    actions: tuple[Ranked, ...]
    hint: str = ""

    @property
    def done(self) -> bool:
        """Whether one of its actions is done."""
        return any(ranked.action.done for ranked in self.actions)

    @property
    def failed(self) -> str | None:
        """The reason that one of its actions gives up for, or `None`."""
        reasons = (ranked.action.failed for ranked in self.actions)
        return next((reason for reason in reasons if reason), None)

    @property
    def goal(self) -> Goal | None:
        """The place that one of its actions goes to, or `None`."""
        goals = (ranked.action.goal for ranked in self.actions)
        return next((goal for goal in goals if goal is not None), None)

    @property
    def wants_scans(self) -> bool:
        """Whether one of its actions looks at scans."""
        return any(ranked.action.wants_scans for ranked in self.actions)

    @classmethod
    def of(cls, name: str, priority: int, actions: Iterable[Ranked], hint: str = "") -> "Stack":
        """Return a stack of `actions`, in any order; ValueError if two have the same name."""
        ordered = tuple(sorted(actions, key=lambda ranked: -ranked.priority))
        names = [ranked.action.name for ranked in ordered]
        if twice := {action for action in names if names.count(action) > 1}:
            raise ValueError(f"stack {name}: two actions are called {', '.join(sorted(twice))}")
        return cls(name, priority, ordered, hint)

    @classmethod
    def alone(cls, action: Action, priority: int) -> "Stack":
        """Return a stack of one action, called as it is."""
        return cls(action.name, priority, (Ranked(0, action),))

    def adding(self, action: Action, priority: int) -> "Stack":
        """Return this with one action more."""
        return Stack.of(
            self.name, self.priority, (*self.actions, Ranked(priority, action)), self.hint
        )

    def at(self, priority: int) -> "Stack":
        """Return the same with another priority against other stacks."""
        return replace(self, priority=priority)


PATIENCE = 15.0
"""People in the way may step aside within this time [s]."""
PROGRESS = 0.1
"""A robot that comes less than this nearer in that time makes no progress [m]."""
LONGEST_GAP = 1.0
"""Longest time between two snapshots that counts [s]: without them, nothing is known."""


@dataclass(slots=True)
class ProgressChecker:
    """Checks whether a robot comes nearer to its goal."""

    _goal: Goal | None = field(default=None, init=False)
    _best: float = field(default=inf, init=False)
    _without: float = field(default=0.0, init=False)
    _checked_at: float = field(default=inf, init=False)

    def check(self, goal: Goal | None, x: float, y: float, now: float) -> bool:
        """Return whether a robot at `x`, `y` [m] makes progress.

        A robot without a goal, with a planned way, or one that follows a person, need not.
        """
        passed = max(0.0, min(now - self._checked_at, LONGEST_GAP))
        self._checked_at = now
        if goal is None or goal.person or goal.to_go is not None:
            self._goal = None
            return True
        distance = hypot(goal.x - x, goal.y - y)
        if goal != self._goal or distance < self._best - PROGRESS:
            self._goal, self._best, self._without = goal, distance, 0.0
        else:
            self._without += passed
        return self._without < PATIENCE
