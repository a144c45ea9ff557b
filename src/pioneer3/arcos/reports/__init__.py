"""Every report of a robot to its host (protocol.md 4, 5), each a frozen dataclass.

Fields hold the numbers on the wire; their names end in the unit, or in `_raw` where the robot
model decides it. Bytes that belong to no field are kept in `extra`.

==========  ============================================================================
module      contents
==========  ============================================================================
session     handshake, configuration, the end
sip         the standard report
devices     sensors, gripper, serial ports, batteries, arm, safety, texts
simulators  simulated lasers and the simulation's state
codec       reports to payloads and back: reading and writing again gives the same bytes
==========  ============================================================================
"""

# Each module's own __all__ is the one list of its names; repeating them here would be a second.
# ruff: noqa: F403
from pioneer3.arcos.layout import Report
from pioneer3.arcos.reports import devices, session, simulators, sip
from pioneer3.arcos.reports.codec import (
    ALL,
    UnknownReport,
    from_payload,
    numbers,
    to_payload,
)
from pioneer3.arcos.reports.devices import *
from pioneer3.arcos.reports.session import *
from pioneer3.arcos.reports.simulators import *
from pioneer3.arcos.reports.sip import *

__all__ = ["ALL", "Report", "UnknownReport", "from_payload", "numbers", "to_payload"]
__all__ += devices.__all__
__all__ += session.__all__
__all__ += simulators.__all__
__all__ += sip.__all__
