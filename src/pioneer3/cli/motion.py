"""`pioneer3 move`, `turn`, `goto`, `wander` and `follow`: the robot drives by itself."""

from collections.abc import Coroutine
from math import radians
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from pioneer3.cli.live import carry_out
from pioneer3.cli.options import (
    LINK,
    MOTION,
    Angle,
    Distance,
    Length,
    LinkOptions,
    MotionOptions,
    Speed,
    TurnRate,
)

if TYPE_CHECKING:
    from pioneer3.runtime.robot import Robot


TURN_RATE = radians(45)


def move(
    distance: Length,
    /,
    *,
    link: LinkOptions = LINK,
    speed: Speed = 0.3,
    max_speed: Speed | None = None,
    motion: MotionOptions = MOTION,
) -> int:
    """Drive straight ahead, or backwards, and stop.

    The robot MOVES, and looks out for nothing but its bumpers: see that the way
    is free. Space stops it, k is the emergency stop.

    Example: pioneer3 move -0.5 --speed 0.2

    Args:
        distance: How far; negative is backwards.
        link: The robot.
        speed: At most.
        max_speed: Keep below this in any case.
        motion: Bounds.
    """
    return carry_out(
        lambda robot: motion.bounded(robot.move(distance, speed)),
        "drives",
        link,
        motion,
        speed=speed,
        max_speed=max_speed,
    )


def turn(
    angle: Angle,
    /,
    *,
    link: LinkOptions = LINK,
    turn_rate: Annotated[TurnRate, Parameter(name=["--turn-rate", "--rate"])] = TURN_RATE,
    motion: MotionOptions = MOTION,
) -> int:
    """Turn on the spot and stop.

    The robot MOVES: see that its corners are free. Space stops it, k is the
    emergency stop.

    Example: pioneer3 turn -90
    Example: pioneer3 turn 1.57rad --turn-rate 20

    Args:
        angle: How far; positive is to the left.
        link: The robot.
        turn_rate: At most.
        motion: Bounds.
    """
    return carry_out(
        lambda robot: motion.bounded(robot.turn(angle, turn_rate)),
        "turns",
        link,
        motion,
        turn_rate=turn_rate,
    )


def goto(
    x: Length,
    y: Length,
    heading: Angle | None = None,
    /,
    *,
    link: LinkOptions = LINK,
    speed: Speed = 0.4,
    max_speed: Speed | None = None,
    motion: MotionOptions = MOTION,
) -> int:
    """Drive to a place and stop; slow down and turn aside for what is in the way.

    The place counts from where the robot is and looks when the connection opens.
    It is found by the wheels, which drift. The robot MOVES: stand by its stop
    button. Space stops it, k is the emergency stop.

    Example: pioneer3 goto 2 -0.5 90

    Args:
        x: Ahead of where it starts.
        y: To the left of where it starts.
        heading: To look in the end, as against the start; without it, as it arrives.
        link: The robot.
        speed: At most.
        max_speed: Keep below this in any case.
        motion: Bounds.
    """

    def going(robot: "Robot") -> Coroutine[Any, Any, None]:
        return motion.bounded(robot.goto(x, y, heading, speed=speed))

    return carry_out(going, "goes there", link, motion, speed=speed, max_speed=max_speed)


def wander(
    *,
    link: LinkOptions = LINK,
    preset: Literal["lab", "aria", "explore"] = "lab",
    speed: Speed | None = None,
    max_speed: Speed | None = None,
    motion: MotionOptions = MOTION,
) -> int:
    """Drive about and keep clear of what is in the way.

    The robot MOVES: stand by its stop button. Space stops it, k is the emergency
    stop.

    Example: pioneer3 wander --port /dev/ttyUSB0 --speed 0.2 --seconds 60

    Args:
        link: The robot.
        preset: lab: slow, as its robotWander; aria: as ARIA's; explore: seeks new ground.
        speed: Where nothing is near; 0.15 of lab, 0.4 of aria, 0.3 of explore.
        max_speed: Keep below this in any case.
        motion: Bounds.
    """
    from pioneer3.behaviors.modes import wander as wandering  # noqa: PLC0415

    mode = wandering(preset=preset, speed=speed)
    return carry_out(
        lambda robot: robot.run(mode, motion.length),
        "wanders",
        link,
        motion,
        speed=speed,
        max_speed=max_speed,
    )


def follow(
    *,
    link: LinkOptions = LINK,
    rule: Literal["tracking", "lab"] = "tracking",
    keep: Distance | None = None,
    max_speed: Speed | None = None,
    motion: MotionOptions = MOTION,
) -> int:
    """Follow the person in front with the front sonars.

    The robot MOVES, and backs up from who comes nearer. Stand 0.6 m in front of it,
    then walk, not faster than 0.4 m/s. Space stops it, k is the emergency stop.

    Example: pioneer3 follow --port /dev/ttyUSB0

    Args:
        link: The robot.
        rule: tracking: remembers who it follows; lab: goes to the nearest echo, as the lab's node.
        keep: Distance to keep; 0.3 unless given.
        max_speed: Keep below this in any case.
        motion: Bounds.
    """
    from pioneer3.behaviors.follow import follow as following  # noqa: PLC0415

    mode = following(rule, keep=keep)
    return carry_out(
        lambda robot: robot.run(mode, motion.length), "follows", link, motion, max_speed=max_speed
    )
