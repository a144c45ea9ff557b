"""A robot's port for a network: one host has the robot, the others watch and may stop it."""

from pioneer3.bridge.bridge import Bridge

__all__ = ["Bridge"]
