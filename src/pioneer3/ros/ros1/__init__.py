"""The edge to ROS 1: the node, and programs on topics. The only part that imports rospy."""
