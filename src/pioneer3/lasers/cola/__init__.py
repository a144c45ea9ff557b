"""SICK's CoLa-A, the text telegrams of LMS-1xx, LMS-5xx and TiM over TCP. No I/O.

=============  ==============================================================================
module         contents
=============  ==============================================================================
wire           frames, words, numbers
scan           LMDscandata, the telegram of a scan, both ways
configuration  the settings that both sides exchange, the numbers of errors and states
families       limits of the LMS-1xx, LMS-5xx and TiM
clock          from the laser's clock to ours
readings       from LMDscandata to a scan in metres
script         the requests up to the first scan, in order
client         the host's side
sweeps         from the readings of a simulated mirror to LMDscandata
unit           a simulated laser without its connections: power, settings, scans
connection     one host at a simulated laser: requests and answers
device         a simulated laser and its connections
=============  ==============================================================================

Facts: docs/reference/cola.md.
"""
