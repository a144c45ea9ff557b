"""The robot's controller: the only part of the simulator that knows ARCOS."""

from pioneer3.sim.firmware.controller import CYCLE, NAME, Firmware

__all__ = ["CYCLE", "NAME", "Firmware"]
