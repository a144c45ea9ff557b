"""ARIA's wander group at work (facts.md 8.4)."""

from collections.abc import Iterator
from contextlib import contextmanager

from pioneer3.behaviors import modes as stacks
from pioneer3.behaviors.action import Stack
from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.driving import speed_gauges, wandering_row
from pioneer3.demo.modes.mode import Mode


def wander(cockpit: Cockpit) -> Mode:
    """Return the mode that drives about by itself."""
    stack: Stack | None = None

    def begin() -> None:
        nonlocal stack
        if not cockpit.drives(stack):
            stack = stacks.wander(preset="aria")
            cockpit.start(stack)

    @contextmanager
    def enter() -> Iterator[None]:
        begin()
        yield

    return Mode(
        key="w",
        name="wander",
        help=("it drives about by itself until another mode",),
        enter=enter,
        again=begin,
        row=lambda: wandering_row(cockpit),
        gauges=lambda: speed_gauges(cockpit),
    )
