"""From options to a running simulator."""

from pioneer3.runtime.simulation.robot import SimulatedRobot
from pioneer3.runtime.simulation.running import RunningSimulation
from pioneer3.runtime.simulation.start import simulator

__all__ = ["RunningSimulation", "SimulatedRobot", "simulator"]
