"""Who drives when several want to; the higher number wins (twist_mux's order, user-needs 6.6)."""

GAMEPAD = 100
KEYBOARD = 90
WEB = 80
PROGRAM = 50
MODE = 20
"""Wander, follow, goto and the like."""
