"""Robots on the other side of ROS topics: finding, reading and driving them."""
