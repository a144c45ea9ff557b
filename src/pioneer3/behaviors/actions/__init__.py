"""Stock actions: one small class each, parameters as fields."""

from pioneer3.behaviors.actions.hold import Hold
from pioneer3.behaviors.actions.move import Move
from pioneer3.behaviors.actions.turn import Turn

__all__ = ["Hold", "Move", "Turn"]
