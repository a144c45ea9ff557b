"""Who drives when several want to; the higher number wins (twist_mux's order, user-needs 6.6)."""

from pioneer3.behaviors.action import MODE

GAMEPAD = 100
KEYBOARD = 90
WEB = 80
PROGRAM = 50

__all__ = ["GAMEPAD", "KEYBOARD", "MODE", "PROGRAM", "WEB"]
