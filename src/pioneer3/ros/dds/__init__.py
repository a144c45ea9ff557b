"""ROS 2 over DDS, by Cyclone DDS, without a ROS installation."""
