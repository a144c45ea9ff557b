"""Places of a map on the command line: a name, or numbers."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.nav.place_text import numbers_of, pose_of

if TYPE_CHECKING:
    from pioneer3.maps import LineMap
    from pioneer3.nav.places import Destination
    from pioneer3.navigation.navigator import Navigator

MapName = Annotated[
    str | None, Parameter(name=["--map", "-m"], env_var="PIONEER3_MAP", metavar="MAP")
]
StartPlace = Annotated[str | None, Parameter(metavar="PLACE", allow_leading_hyphen=True)]


def start_of(place: str | None, command: str) -> "Pose2 | str | None":
    """Return the start on a map: a pose, a name, or `None` for where the robot was last."""
    return None if place is None else pose_of(place, command)


def destination_of(
    name: str, words: Sequence[str], line_map: "LineMap", command: str
) -> "Destination":
    """Return the place at x, y and perhaps a heading, if that is what the words are, or by name.

    Raises:
        ConfigError: A number is wrong, or the map has no such place.
    """
    from pioneer3.nav.places import Destination, find_place

    numbers = numbers_of(words, command)
    return find_place(line_map, name) if numbers is None else Destination(**numbers)  # type: ignore[arg-type]


async def require_place(navigator: "Navigator", command: str, *, looks: bool) -> None:
    """Wait until it is sure where the robot is; have it look around first if it `looks`.

    A goal waits for the same, but knows no options to advise.

    Raises:
        MotionError: It is not sure; says how to tell.
    """
    if looks:
        await navigator.look_around()
    elif not await navigator.find():
        raise MotionError(
            f"{command}: it is not sure where the robot is: {navigator.estimate.reason}; without "
            "--start it is looked for where it was last, and at the map's home: give --start PLACE "
            "or --start X,Y,HEADING; or have it found: --start unknown, or --look-around if it "
            "stands near the place"
        )
