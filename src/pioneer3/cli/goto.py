"""`pioneer3 goto`: to a place of the map by its name, or to a point."""

from collections.abc import Coroutine
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from pioneer3.behaviors.modes import Goto
from pioneer3.cli.live import carry_out
from pioneer3.cli.options import (
    LINK,
    MOTION,
    LinkOptions,
    MotionOptions,
    Speed,
)
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.units import ANGLE, LENGTH

if TYPE_CHECKING:
    from pioneer3.runtime.robot import Robot

UNITS = LENGTH, LENGTH, ANGLE


def goto(
    *place: Annotated[str, Parameter(allow_leading_hyphen=True)],
    link: LinkOptions = LINK,
    map_: Annotated[
        str | None, Parameter(name=["--map", "-m"], env_var="PIONEER3_MAP", metavar="MAP")
    ] = None,
    start: Annotated[str | None, Parameter(metavar="PLACE", allow_leading_hyphen=True)] = None,
    speed: Speed = 0.3,
    max_speed: Speed | None = None,
    motion: MotionOptions = MOTION,
) -> int:
    """Drive to a place and stop.

    With a map and a laser the robot finds itself on the map, plans a way through
    the doors, and drives around what is not on the map. Without a map it drives
    straight, slows down and turns aside for obstacles; the place then counts from
    where the robot is and looks when the connection opens, found by the wheels,
    which drift.

    The robot MOVES: stand by its stop button. Space stops it, k is the emergency
    stop.

    Example: pioneer3 goto kitchen --map office
    Example: pioneer3 goto 2 -0.5 90

    Args:
        place: A name of the map; or x, y, and a heading to turn to there.
        link: The robot.
        map_: The map: a file, or the name of one that ships.
        start: Where the robot is: a name, or x,y,heading; without it at the map's home.
        speed: At most.
        max_speed: Keep below this in any case.
        motion: Bounds.
    """
    numbers = _numbers(place)
    if map_ is None:
        if numbers is None:
            words = " ".join(place) or "nowhere"
            raise ConfigError(f"goto {words}: a place has a name only on a map: give it with --map")
        return _straight(Goto(**numbers, speed=speed), link, motion, max_speed=max_speed)

    def going(robot: "Robot") -> Coroutine[Any, Any, None]:
        return motion.bounded(_along_a_way(robot, " ".join(place), numbers, speed))

    return carry_out(
        going,
        "drives along a planned way",
        link,
        motion,
        speed=speed,
        max_speed=max_speed,
        line_map=map_,
        start=None if start is None else _pose(start),
    )


def _straight(
    mode: Goto, link: LinkOptions, motion: MotionOptions, *, max_speed: float | None
) -> int:
    def going(robot: "Robot") -> Coroutine[Any, Any, None]:
        return motion.bounded(robot.run(mode.stack(robot.info.limits)))

    return carry_out(going, mode.doing, link, motion, speed=mode.speed, max_speed=max_speed)


async def _along_a_way(
    robot: "Robot", name: str, numbers: dict[str, float] | None, speed: float
) -> None:
    from pioneer3.nav.places import Destination

    if numbers is None:
        await robot.goto(name, speed=speed)
        return
    assert robot.navigator is not None
    await robot.navigator.goto(Destination(**numbers), speed)  # type: ignore[arg-type]


def _numbers(words: tuple[str, ...]) -> dict[str, float] | None:
    """Return x, y and heading, or `None` where the words are a name.

    Raises:
        ConfigError: They are too few or too many, or one of them is no number.
    """
    if not words or not words[0].lstrip("+-")[:1].isdigit():
        return None
    if not 2 <= len(words) <= len(UNITS):
        raise ConfigError(f"goto {' '.join(words)}: give x and y, or x, y and a heading")
    try:
        values = [quantity.read(word) for quantity, word in zip(UNITS, words, strict=False)]
    except ValueError as error:
        raise ConfigError(f"goto {' '.join(words)}: {error}") from None
    return dict(zip(("x", "y", "heading"), values, strict=False))


def _pose(text: str) -> Pose2 | str:
    """Return the pose `x,y,heading`, or the name of a place.

    Raises:
        ConfigError: A number is wrong.
    """
    numbers = _numbers(tuple(text.split(",")))
    if numbers is None:
        return text
    return Pose2(numbers["x"], numbers["y"], numbers.get("heading", 0.0))
