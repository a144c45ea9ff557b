"""Places for robots: footprints, free space, and starts.

==========  =========================================================================
module      contents
==========  =========================================================================
spawn       robots at the beginning of a simulation: their models, names and starts
placer      finds starts for robots: a home, a given pose, beside the map or anywhere
free_space  free space
footprint   the footprint of a robot: its rectangle, and the circle it needs to turn
==========  =========================================================================
"""
