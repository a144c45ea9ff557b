"""Hokuyo's SCIP 2.0 and 1.1, both sides, without I/O.

==========  ================================================================================
module      contents
==========  ================================================================================
wire        lines, checksums, characters and numbers, a stream of bytes cut into answers
scans       the data of scans: distances, intensities, several echoes; codes below DMIN
identity    the answers to VV, PP and II
timing      the laser's clock beside ours
stream      the scans that a laser is asked for
start       the dialogue that makes a laser scan, whatever state it is in
client      the host's side: `ScipClient`
device      the laser's side: `ScipDevice`
unit        one laser: laser, motor, clock, identity
session     one host at that: commands and answers
requests    the parameters of measuring commands
sweeps      readings of one turn as SCIP sends them
==========  ================================================================================

Facts: docs/reference/scip.md.
"""
