"""The robot in ROS: conversions, and the nodes that use them."""
