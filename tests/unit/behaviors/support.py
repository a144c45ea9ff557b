"""Situations to decide on."""

from dataclasses import replace
from math import cos, inf, pi, sin

from pioneer3.behaviors.action import Combined, Desire, Situation, Weighted, as_weighted
from pioneer3.behaviors.engine import Proposal, combine
from pioneer3.behaviors.surroundings import FieldOfView, Surroundings
from pioneer3.geometry import ORIGIN, STILL, Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.models import RobotModel, load_model
from pioneer3.state import Battery, Bumpers, Inputs, Motors, Odometry, Snapshot, Sonar

P3AT = load_model("p3at-sh")
LIMITS = Limits(
    max_speed=0.75,
    max_turn_rate=1.7,
    acceleration=0.3,
    deceleration=1.5,
    turn_acceleration=1.7,
    turn_deceleration=5.0,
)


def seen(
    now: float = 0.0,
    *,
    pose: Pose2 = ORIGIN,
    twist: Twist2 = STILL,
    motors: Motors | None = None,
    bumpers: Bumpers | None = None,
    around: Surroundings | None = None,
    higher: Combined | None = None,
    inputs: Inputs | None = None,
    sequence: int = 1,
    model: RobotModel = P3AT,
) -> Situation:
    """Return a robot's situation, a P3-AT's unless said; nothing is around unless said."""
    odometry = Odometry(robot_in_odom=pose, twist=twist, left_speed=twist.v, right_speed=twist.v)
    snapshot = Snapshot(
        stamp=now,
        sequence=sequence,
        odometry=odometry,
        battery=Battery(voltage=12),
        motors=motors or Motors(enabled=True),
        bumpers=bumpers or Bumpers(),
        inputs=inputs or Inputs(),
    )
    return Situation(
        now=now,
        snapshot=snapshot,
        model=model,
        limits=LIMITS,
        around=around or Surroundings(pose),
        higher=higher or Combined(),
    )


def around(*polar: tuple[float, float], pose: Pose2 = ORIGIN) -> Surroundings:
    """Return surroundings with points at (distance from the centre [m], bearing [rad])."""
    points = [pose @ Pose2(d * cos(b), d * sin(b)) for d, b in polar if d < inf]
    return Surroundings(pose, [(p.x, p.y) for p in points], [(p.x, p.y) for p in points])


def looking_ahead(*polar: tuple[float, float], sonar: bool = False) -> Situation:
    """Return the situation of a robot that senses half a turn ahead, and has seen these points."""
    place = around(*polar)
    half = Surroundings(
        ORIGIN, [(p.x, p.y) for p in place.points()], fields=[FieldOfView(-pi / 2, pi / 2)]
    )
    situation = seen(around=half)
    return replace(situation, snapshot=replace(situation.snapshot, sonar=Sonar(enabled=sonar)))


def above(desire: Desire) -> Combined:
    """Return the desires of a higher priority."""
    return combine(Combined(), [Proposal("above", desire)], 0.0)


def value(desire: Desire | None, channel: str) -> float | None:
    """Return the value that is asked of a channel, or `None`."""
    wish: Weighted | None = as_weighted(getattr(desire, channel)) if desire is not None else None
    return wish.value if wish else None
