"""Actions, and named stacks of them."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Protocol

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.goal import Goal
from pioneer3.behaviors.situation import Situation

MODE = 20
"""Priority of modes against other stacks: below every hand and program at the controls."""


class Action(Protocol):
    """Anything with a name that turns a situation into a desire. Its priority is its place."""

    @property
    def name(self) -> str:
        """Shown to people; unique in its stack."""

    def decide(self, situation: Situation) -> Desire | None:
        """Return what this action wants now, or `None`. Asked once per reading of the robot."""


@dataclass(frozen=True, slots=True)
class Ranked:
    """An action at its place in a stack; the higher priority decides first."""

    priority: int
    action: Action


@dataclass(frozen=True, slots=True)
class Stack:
    """A mode: actions that drive together.

    Attributes:
        name: Shown to people.
        priority: Against other stacks; within, each action has its own.
        actions: Highest priority first.
        hint: What it does, in a sentence.
    """

    name: str
    priority: int
    actions: tuple[Ranked, ...]
    hint: str = ""

    @property
    def done(self) -> bool:
        """Whether one of its actions has done what it was for (its `done`); most never are."""
        return any(getattr(ranked.action, "done", False) for ranked in self.actions)

    @property
    def goal(self) -> Goal | None:
        """Where one of its actions is going to (its `goal`); most go nowhere."""
        goals = (getattr(ranked.action, "goal", None) for ranked in self.actions)
        return next((goal for goal in goals if goal is not None), None)

    @classmethod
    def of(cls, name: str, priority: int, actions: Iterable[Ranked], hint: str = "") -> "Stack":
        """Return a stack of `actions`, given in any order.

        Raises:
            ValueError: two of them have the same name.
        """
        ordered = tuple(sorted(actions, key=lambda ranked: -ranked.priority))
        names = [ranked.action.name for ranked in ordered]
        if twice := {action for action in names if names.count(action) > 1}:
            raise ValueError(f"stack {name}: two actions are called {', '.join(sorted(twice))}")
        return cls(name, priority, ordered, hint)

    @classmethod
    def alone(cls, action: Action, priority: int) -> "Stack":
        """Return a stack of one action, called as it is."""
        return cls(action.name, priority, (Ranked(0, action),))

    def adding(self, action: Action, priority: int) -> "Stack":
        """Return this with one action more."""
        return Stack.of(
            self.name, self.priority, (*self.actions, Ranked(priority, action)), self.hint
        )

    def at(self, priority: int) -> "Stack":
        """Return the same with another priority against other stacks."""
        return replace(self, priority=priority)
