"""Priorities of inputs: the higher number drives (the order of twist_mux, facts.md 14.6)."""

from pioneer3.behaviors.action import MODE

GAMEPAD = 100
KEYBOARD = 90
WEB = 80
PROGRAM = 50

__all__ = ["GAMEPAD", "KEYBOARD", "MODE", "PROGRAM", "WEB"]
