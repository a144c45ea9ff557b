"""The robot's controller: the only part of the simulator that knows ARCOS.

===========  ===============================================================================
module       contents
===========  ===============================================================================
controller   the robot's controller: commands become motion, the world becomes reports
steering     carries out the commands that drive (protocol.md 3.1)
laser        the laser in the robot's own stream
instruments  the contents of the standard report, measured by the controller (protocol.md 4)
console      commands of a client to the simulator itself (protocol.md 3.3, 5.13)
===========  ===============================================================================
"""

from pioneer3.sim.firmware.controller import CYCLE, NAME, Firmware

__all__ = ["CYCLE", "NAME", "Firmware"]
