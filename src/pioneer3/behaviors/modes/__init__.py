"""Modes: behaviors that drive by themselves, each described once, in a file of its own.

=======  ===================================================
module   contents
=======  ===================================================
group    the modes of several robots together
by_hand  stacks for the demo, which people or a camera steer
goto     modes that turn the robot, or drive it to a place
wander   the mode that wanders (facts.md 7.7)
follow   the mode that follows a person
mode     the description of a mode
=======  ===================================================

The page's forms, the HTTP API, the command line, ROS's demos, the demo and the table in
`docs/how-to/behave.md` are made from :data:`MODES`.
"""

from typing import TYPE_CHECKING, Union

from pioneer3.behaviors.modes.follow import Follow, follow
from pioneer3.behaviors.modes.goto import Goto, Turn, goto
from pioneer3.behaviors.modes.mode import Mode
from pioneer3.behaviors.modes.wander import Preset, Wander, wander

MODES: tuple[type[Mode], ...] = (
    Wander,
    Follow,
    Goto,
    Turn,
)
"""All modes, in the order in which people see them. A new mode is a file and one line here."""

if TYPE_CHECKING:
    AnyMode = Mode
    """The type to decode a mode as: a tagged union."""
else:
    AnyMode = Union[MODES]  # noqa: UP007  a tuple of types

__all__ = [
    "MODES",
    "AnyMode",
    "Follow",
    "Goto",
    "Mode",
    "Preset",
    "Turn",
    "Wander",
    "follow",
    "goto",
    "wander",
]
