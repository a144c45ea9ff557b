"""`pioneer3 goto` and `patrol`: to places of the map by their names, or to points."""

from collections.abc import Coroutine
from math import inf
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from cyclopts.validators import Number

from pioneer3.behaviors.modes import Goto
from pioneer3.cli.live import carry_out
from pioneer3.cli.options import (
    LINK,
    MOTION,
    NAVIGATION,
    Flag,
    LinkOptions,
    MaxSpeed,
    MotionOptions,
    NavigationOptions,
    Speed,
)
from pioneer3.cli.places import MapName, StartPlace, destination_of, require_place, start_of
from pioneer3.errors import ConfigError
from pioneer3.nav.place_text import numbers_of

if TYPE_CHECKING:
    from pioneer3.runtime.robot import Robot


def goto(
    *place: Annotated[str, Parameter(allow_leading_hyphen=True)],
    link: LinkOptions = LINK,
    map_: MapName = None,
    start: StartPlace = None,
    look_around: Flag = False,
    speed: Speed = 0.3,
    max_speed: MaxSpeed | None = None,
    motion: MotionOptions = MOTION,
    navigation: NavigationOptions = NAVIGATION,
) -> int:
    """Drive to a place and stop.

    With a map and a laser the robot finds itself on the map, plans a way through
    the doors, and drives around what is not on the map. It is looked for where it
    was when a program ended, and at the map's home; elsewhere give its place with
    --start. Numbers without a map count from where the robot is and looks when the
    connection opens, found by the wheels, which drift; it drives straight, slows
    down and turns aside for obstacles.

    The robot MOVES: stand by its stop button. Any key stops it, k is the emergency
    stop.

    Example: pioneer3 goto kitchen --map office
    Example: pioneer3 goto lobby --map office --start kitchen
    Example: pioneer3 goto home --map office --start unknown
    Example: pioneer3 goto 2 -0.5 90

    Args:
        place: A name of the map; or x, y, and a heading to turn to there.
        map_: The map: a file, or the name of one that ships; a name of a place without it is on a
            simulator's own.
        start: Where the robot is: a name, `x,y,heading`, or `unknown`; without it as it was last.
        look_around: Drive about a little first if it is not sure where it is.
        speed: At most.
    """
    from pioneer3.navigation.simulator import OF_SIMULATOR

    if not place:
        raise ConfigError("goto: give a name of the map, or x and y, or x, y and a heading")
    numbers = numbers_of(place, "goto")
    if map_ is None and numbers is not None:
        return _straight(Goto(**numbers, speed=speed), link, motion, max_speed=max_speed)

    async def going(robot: "Robot") -> None:
        navigator = robot.navigator
        assert navigator is not None
        there = destination_of(" ".join(place), place, navigator.line_map, "goto")
        await require_place(navigator, f"goto {there}", looks=look_around or start == "unknown")
        await navigator.goto(there, speed)

    return carry_out(
        lambda robot: motion.bounded(going(robot)),
        "drives along a planned way",
        link,
        motion,
        speed=speed,
        max_speed=max_speed,
        line_map=map_ or OF_SIMULATOR,
        start=start_of(start, "goto"),
        navigation=navigation,
    )


def _straight(
    mode: Goto, link: LinkOptions, motion: MotionOptions, *, max_speed: float | None
) -> int:
    def going(robot: "Robot") -> Coroutine[Any, Any, None]:
        return motion.bounded(robot.run(mode.stack(robot.info.limits)))

    return carry_out(going, mode.doing, link, motion, speed=mode.speed, max_speed=max_speed)


def patrol(
    *places: Annotated[str, Parameter(allow_leading_hyphen=True)],
    link: LinkOptions = LINK,
    map_: MapName = None,
    start: StartPlace = None,
    look_around: Flag = False,
    rounds: Annotated[int | None, Parameter(validator=Number(gte=1))] = None,
    speed: Speed = 0.3,
    max_speed: MaxSpeed | None = None,
    motion: MotionOptions = MOTION,
    navigation: NavigationOptions = NAVIGATION,
) -> int:
    """Drive from place to place, and begin anew after the last one.

    It stands 3 s at each place. A place that no way leads to is left out until the
    next round.

    The robot MOVES: stand by its stop button. Any key stops it, k is the emergency
    stop.

    Example: pioneer3 patrol Lab Kitchen home --map office --rounds 3
    Example: pioneer3 patrol 7,5 12.4,9.4,90 --map office --port /dev/ttyUSB0

    Args:
        places: Names of the map, or `x,y`, or `x,y,heading`; `home` is where robots begin.
        map_: The map: a file, or the name of one that ships; else a simulator's own.
        start: Where the robot is: a name, `x,y,heading`, or `unknown`; without it as it was last.
        look_around: Drive about a little first if it is not sure where it is.
        rounds: So many; without it until it is stopped.
        speed: At most.
    """
    from pioneer3.navigation.simulator import OF_SIMULATOR

    if len(places) < 2:
        raise ConfigError("patrol: give two places or more, such as: patrol Lab Kitchen")

    async def going(robot: "Robot") -> None:
        navigator = robot.navigator
        assert navigator is not None
        known = navigator.line_map
        goals = [destination_of(one, one.split(","), known, "patrol") for one in places]
        await require_place(navigator, "patrol", looks=look_around or start == "unknown")
        await navigator.patrol(goals, speed, rounds or inf)

    return carry_out(
        lambda robot: motion.bounded(going(robot)),
        "drives from place to place",
        link,
        motion,
        speed=speed,
        max_speed=max_speed,
        line_map=map_ or OF_SIMULATOR,
        start=start_of(start, "patrol"),
        navigation=navigation,
    )
