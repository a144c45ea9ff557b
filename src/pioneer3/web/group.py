"""Modes of several robots of the page: their followers obey the operator that starts them."""

from math import inf
from typing import TYPE_CHECKING

from pioneer3.behaviors.modes.group import GroupMode
from pioneer3.errors import Refusal
from pioneer3.navigation.group import stacks_of
from pioneer3.web.control import SILENCE, Operator

if TYPE_CHECKING:
    from pioneer3.web.page import Page


def start(
    page: "Page",
    operator: Operator,
    mode: GroupMode,
    robots: tuple[int, ...],
    leader: int | None,
    *,
    waits: bool = True,
) -> Refusal | None:
    """Start a mode of several robots.

    All robots begin or none does. Control of each is taken by itself; the leader, the number of one
    of them or `None`, is left to whoever drives it. With `waits` the mode ends when nothing is
    heard of the operator, as of a page.

    Raises:
        CommandError: There is no such robot.
        MotionError: They cannot drive together; the message says why.
    """
    views = {view.name: view for view in map(page.robot, dict.fromkeys(robots))}
    first = page.robot(leader).name if mode.led and leader is not None else None
    for name, view in views.items():
        holder = view.control.holder
        if name != first and holder is not None and holder is not operator:
            return Refusal(f"{name}: {holder.name} has control")
    driven = {name: view.robot for name, view in views.items()}
    stacks = stacks_of(mode, driven, first, page.traffic)
    for name, stack in stacks.items():
        refused = views[name].control.start(
            operator, stack, mode.seconds, patience=SILENCE if waits else inf
        )
        if refused:
            for other in stacks:
                if driven[other].arbiter.mode is stacks[other]:
                    driven[other].arbiter.end_mode(f"{name} did not begin")
            return Refusal(f"{name}: {refused}")
    return None
