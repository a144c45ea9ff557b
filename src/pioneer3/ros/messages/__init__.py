"""Readings to messages and back. Needs no ROS: message classes are handed in."""
