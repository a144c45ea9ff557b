"""Groups of geoms: which of them sensors meet, and which are drawn."""

COUNT = 6
"""Number of MuJoCo's groups."""
WALLS, THINGS, PARTS, TOUCHING, BODIES, LEGS = range(COUNT)
"""Tall walls; the floor and all else that sensors meet; small parts of robots, which are only
drawn; solids that only touch; people as sonars and eyes meet them, and as lasers do."""
DRAWN = WALLS, THINGS, PARTS, BODIES
"""By cameras."""
