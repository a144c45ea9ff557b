"""Behaviors: actions with priorities, whose desires one resolver merges. Pure.

An action has a name and turns a :class:`Situation` into a :class:`Desire`, or `None`. A mode is a
:class:`Stack` of actions, each at its priority; those that people choose by name are in
:mod:`pioneer3.behaviors.modes`, the stock actions in :mod:`pioneer3.behaviors.actions`.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pioneer3.behaviors.action import Action, Desire, Ranked, Situation, Stack, Weighted
    from pioneer3.behaviors.engine import Decision, resolve
    from pioneer3.behaviors.surroundings import Buffer, Echo, Surroundings

_HOME = {
    "Action": "action",
    "Buffer": "surroundings",
    "Decision": "engine",
    "Desire": "action",
    "Echo": "surroundings",
    "Ranked": "action",
    "Situation": "action",
    "Stack": "action",
    "Surroundings": "surroundings",
    "Weighted": "action",
    "resolve": "engine",
}

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


def __getattr__(name: str) -> Any:
    """Import public names at their first use: `--help` reads the modes only (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module 'pioneer3.behaviors' has no attribute {name!r}")
    return getattr(import_module(f"pioneer3.behaviors.{_HOME[name]}"), name)
