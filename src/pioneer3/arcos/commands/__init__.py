"""Every command of a host to a robot (protocol.md 3).

A class has the ARCOS name in CamelCase (`VEL` is :class:`Vel`), SI units, and its number as `ID`.
Where a report has the same name, the command is called `Request...` (`CONFIG` is
:class:`RequestConfig`). Commands that this package neither sends nor acts on are lines of a table,
and have the ARCOS name itself: `named("ROTKP", 40)`.

==========  =====================================================================
module      contents
==========  =====================================================================
driving     session, motion, limits
devices     sensors, inputs and outputs, gripper, serial ports, sounds, batteries
simulators  for simulators only
table       all others
codec       commands to payloads and back
arguments   arguments of commands on the wire, and their units (protocol.md 1.3)
==========  =====================================================================
"""

# Each module's own __all__ is the one list of its names; repeating them here would be a second.
# ruff: noqa: F403
from pioneer3.arcos.commands import arguments, devices, driving, simulators
from pioneer3.arcos.commands.arguments import *
from pioneer3.arcos.commands.codec import (
    NUMBERS,
    Unknown,
    every_command,
    from_payload,
    is_old,
    moves,
    named,
    to_payload,
)
from pioneer3.arcos.commands.devices import *
from pioneer3.arcos.commands.driving import *
from pioneer3.arcos.commands.simulators import *
from pioneer3.arcos.layout import Command

__all__ = [
    "NUMBERS",
    "Command",
    "Unknown",
    "every_command",
    "from_payload",
    "is_old",
    "moves",
    "named",
    "to_payload",
]
__all__ += arguments.__all__
__all__ += devices.__all__
__all__ += driving.__all__
__all__ += simulators.__all__
