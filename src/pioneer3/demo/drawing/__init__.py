"""Pictures to scale, made of characters."""

from pioneer3.demo.drawing.canvas import Canvas, Ink
from pioneer3.demo.drawing.ring import reach_for, ring

__all__ = ["Canvas", "Ink", "reach_for", "ring"]
