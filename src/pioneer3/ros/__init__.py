"""The robot in ROS: messages, nodes and clients over any middleware, and the edge to ROS 1."""
