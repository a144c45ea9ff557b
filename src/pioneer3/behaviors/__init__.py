"""Behaviors: actions with priorities, whose desires one resolver merges. Pure.

An action has a name and turns a :class:`Situation` into a :class:`Desire`, or `None`. A mode is a
:class:`Stack` of actions, each at its priority; those that people choose by name are in
:mod:`pioneer3.behaviors.modes`, the stock actions in :mod:`pioneer3.behaviors.actions`.
"""

from pioneer3.behaviors.action import Action, Desire, Ranked, Situation, Stack, Weighted
from pioneer3.behaviors.engine import Decision, resolve
from pioneer3.behaviors.surroundings import Buffer, Echo, Surroundings

__all__ = [
    "Action",
    "Buffer",
    "Decision",
    "Desire",
    "Echo",
    "Ranked",
    "Situation",
    "Stack",
    "Surroundings",
    "Weighted",
    "resolve",
]
