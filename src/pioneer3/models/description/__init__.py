"""Frames, links and shapes of a robot, from its model."""
