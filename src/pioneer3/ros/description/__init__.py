"""What a robot looks like and where everything on it is, from its model. Needs no ROS."""
