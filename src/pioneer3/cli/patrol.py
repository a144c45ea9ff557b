"""`pioneer3 patrol`: from place to place of a map, again and again."""

from math import inf
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter, validators

from pioneer3.cli.live import carry_out
from pioneer3.cli.options import (
    LINK,
    MOTION,
    NAVIGATION,
    Flag,
    LinkOptions,
    MotionOptions,
    NavigationOptions,
    Speed,
)
from pioneer3.cli.places import MapName, StartPlace, destination_of, require_place
from pioneer3.errors import ConfigError
from pioneer3.nav.place_text import pose_of

if TYPE_CHECKING:
    from pioneer3.runtime.robot import Robot


def patrol(
    *places: Annotated[str, Parameter(allow_leading_hyphen=True)],
    link: LinkOptions = LINK,
    map_: MapName = None,
    start: StartPlace = None,
    look_around: Flag = False,
    rounds: Annotated[int | None, Parameter(validator=validators.Number(gte=1))] = None,
    speed: Speed = 0.3,
    max_speed: Speed | None = None,
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
        link: The robot.
        map_: The map: a file, or the name of one that ships; else a simulator's own.
        start: Where the robot is: a name, `x,y,heading`, or `unknown`; else at the map's home.
        look_around: Drive about a little first if it is not sure where it is.
        rounds: So many; without it until it is stopped.
        speed: At most.
        max_speed: Keep below this in any case.
        motion: Bounds.
        navigation: Settings.
    """
    from pioneer3.navigation.simulator import OF_SIMULATOR

    if len(places) < 2:
        raise ConfigError("patrol: give two places or more, such as: patrol Lab Kitchen")

    async def going(robot: "Robot") -> None:
        navigator = robot.navigator
        assert navigator is not None
        goals = [destination_of(text, navigator.line_map, "patrol") for text in places]
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
        start=None if start is None else pose_of(start, "patrol"),
        navigation=navigation,
    )
