"""A bridge between a network of ROS 1 and one of ROS 2, by a table of topics."""
