"""Behaviors: actions with priorities, whose desires one resolver merges. Pure.

============  ====================================================================================
module        contents
============  ====================================================================================
action        the parts of a decision: situations, desires, actions, and stacks of actions
engine        resolves prioritised actions. Pure: situation in, decision out; no link, no logging
surroundings  obstacles around the robot, as its range sensors see them and have seen them
memory        remembers points that range sensors saw, in odometry's frame (facts.md 7.2)
actions       stock actions: one small class each, parameters as fields
modes         modes: behaviors that drive by themselves, each described once, in a file of its own
explanations  decisions explained to people: the actions, their parts and their reasons
trackers      chooses the person to follow and keeps to them
tracking      the track of a person by the echoes of sonars
leg_tracking  tracks all people in the scans of a laser, and all else that looks like legs
legs          finds legs in the scan of a laser: narrow round clusters that stand free
detection     finds a person among the echoes of sonars: clutter and walls are left out
pings         single firings of sonar transducers, placed in odometry's frame
kalman        the filter that estimates the position and the velocity of a person who walks
peers         other robots of a group, as one of them knows them
formations    formations: the places of robots beside and behind their leader
============  ====================================================================================

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
    "Buffer": "surroundings",
    "Decision": "engine",
    "Echo": "surroundings",
    "Surroundings": "surroundings",
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
    if name not in __all__:
        raise AttributeError(f"module 'pioneer3.behaviors' has no attribute {name!r}")
    return getattr(import_module(f"pioneer3.behaviors.{_HOME.get(name, 'action')}"), name)
