"""The simulator on the network and in time."""

from pioneer3.sim.server.simulation import Simulation

__all__ = ["Simulation"]
