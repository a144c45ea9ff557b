"""What the robot wants to do: actions with priorities, merged by one resolver. Pure.

An action has a name and turns a :class:`Situation` into a :class:`Desire`, or `None`. A mode is a
:class:`Stack` of actions, each at its priority; those that people choose by name are in
:mod:`pioneer3.behaviors.modes`, the stock actions in :mod:`pioneer3.behaviors.actions`.
"""

from pioneer3.behaviors.desire import Desire, Wish
from pioneer3.behaviors.engine import Decision, resolve
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.stack import Action, Ranked, Stack
from pioneer3.behaviors.surroundings import Echo, Recall, Surroundings

__all__ = [
    "Action",
    "Decision",
    "Desire",
    "Echo",
    "Ranked",
    "Recall",
    "Situation",
    "Stack",
    "Surroundings",
    "Wish",
    "resolve",
]
