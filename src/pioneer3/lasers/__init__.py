"""Laser range finders: their protocols, both sides, without I/O.

===========  ================================================================================
module       contents
===========  ================================================================================
client       the host's side as all protocols have it: events, scans, the `LaserClient` protocol
dialogue     scripts of requests, pauses and answers, until the laser scans
device       the laser's side as simulators use it: the mirror's turns, `LaserDevice`
scip         Hokuyo's SCIP 1.1 and 2.0
lms2xx       SICK's telegrams of the LMS-2xx
cola         SICK's CoLa-A: LMS-1xx, LMS-5xx, TiM
recognition  recognises a laser by the bytes it sends, whatever its protocol. Pure
line         the sending half of a line: bytes leave one after the other at its speed. No I/O
clock        the difference between a laser's clock and ours, as arrivals tell it. No I/O
===========  ================================================================================

Facts: docs/reference/scip.md, lms2xx.md, cola.md.
"""
