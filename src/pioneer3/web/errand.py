"""A way that a script asks for, over the API."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pioneer3.errors import PioneerError
from pioneer3.maps import LineMap
from pioneer3.web import messages
from pioneer3.web.control import Operator

if TYPE_CHECKING:
    from pioneer3.nav.places import Destination

PlaceOn = Callable[[LineMap], "Destination"]
"""Returns a place on a map, or raises a PioneerError."""


@dataclass(frozen=True, slots=True, eq=False)
class Errand:
    """A way that a script asks for; it gets an answer, whatever happens.

    Attributes:
        operator: The script.
        place: The goal.
        speed: At most [m/s].
        drives: Whether the robot drives along the way.
        after: Number of the last stop before.
        answer: Gets the way.
    """

    operator: Operator
    place: PlaceOn
    speed: float
    drives: bool
    after: int
    answer: asyncio.Future[messages.Way]

    def refuse(self, error: PioneerError) -> None:
        """Answer with an error, unless there is an answer."""
        if not self.answer.done():
            self.answer.set_exception(error)
