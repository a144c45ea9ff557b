"""A robot as a ROS node, over any middleware: topics, services, parameters, commands."""
