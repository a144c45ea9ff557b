"""Finds robots on ports, and explains faults between this computer and a robot."""
