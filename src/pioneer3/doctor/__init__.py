"""Finds robots on ports, and finds and explains what is wrong between this computer and a robot."""
