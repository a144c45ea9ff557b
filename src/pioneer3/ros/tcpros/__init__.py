"""A node of ROS 1 without ROS 1: the protocols of its topics and services, and of its master."""
