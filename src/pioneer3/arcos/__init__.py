"""The robot's protocol (ARCOS, P2OS, AROS), without I/O: bytes and the time in, bytes out.

===========  =====================================================================================
module       contents
===========  =====================================================================================
host         the host's side of an ARCOS session. No I/O: bytes and the time come in, bytes go out
host_events  the timing, the states and the events of a host's session
device       the robot's side of an ARCOS session, as tolerant as the firmware. No I/O
commands     every command of a host to a robot (protocol.md 3)
reports      every report of a robot to its host (protocol.md 4, 5), each a frozen dataclass
lists        kinds that hold several values: sequences and records
layout       declarative layouts: the annotations of a message class describe its bytes
wire         kinds of single values on the wire, with which the fields of messages are annotated
packet       ARCOS packets
===========  =====================================================================================
"""
