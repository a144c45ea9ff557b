"""Checks a robot's node of ROS 2, ours or anybody's, against the table of topics and services."""
