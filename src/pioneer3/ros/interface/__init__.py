"""What ROS sees of a robot: topics, names, parameters, and whose commands count. Needs no ROS."""
