"""The inner loops of navigation: written once, compiled by numba where it is installed.

==========  ===============================================================================
module      contents
==========  ===============================================================================
fields      distances and ways over a raster of cells: from walls, to goals, between places
ways        ways down a field of costs
arcs        the motions that a robot can begin now, and what each would meet
clearance   the room between an outline and walls along a motion
manoeuvres  short drives to and fro, found by a search over places and headings
rays        rays through the cells of a map, and cells in which unknown things were seen
scans       how well scans fit the walls of a map, and the poses at which they fit best
pings       how well the pings of sonars fit the walls of a map
normals     directions of walls at the points of a scan
matching    points of a scan against the points of others
==========  ===============================================================================
"""

from pathlib import Path

from pioneer3.jit import KernelCache

CACHE = KernelCache(Path(__file__).parent)
