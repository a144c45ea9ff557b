"""Readings to messages and back. Needs no ROS: message classes are handed in.

===========  ======================================================================================
module       contents
===========  ======================================================================================
goals        goals of an action server to messages of actionlib_msgs and move_base_msgs
navigation   maps, the place on them, ways and goals to ROS messages; starts and goals from them
diagnostics  the state of the robot, part by part, for diagnostic_msgs
motion       odometry, wheels and transforms to ROS messages, and a `Twist` to ours
sensors      sonars, laser, camera, gyro, bumpers, battery and inputs to ROS messages
update       the input of every conversion to ROS messages, and the options that shape the messages
===========  ======================================================================================
"""
