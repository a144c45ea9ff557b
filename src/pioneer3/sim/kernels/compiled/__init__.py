"""The loops that numba compiles. Each runs over robots `first` to `last`, so threads can share.

Names: a ray starts at (ox, oy) and runs along the unit vector (dx, dy); (ax, ay) and (bx, by) are
the ends of a segment; lattice units are cells. Arrays are those of Grid, Robots, Mounts, Fan and
Drives.
"""
