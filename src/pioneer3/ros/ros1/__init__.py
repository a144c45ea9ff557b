"""ROS 1: nodes and clients on rospy. The only part that imports it."""
