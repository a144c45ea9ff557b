"""ROS 1: nodes and clients on rospy. The only part that imports it.

===========  ======================================================================================
module       contents
===========  ======================================================================================
client       programs on ROS 1 that find robots and drive them by their topics, from any computer
start        starts the ROS 1 node: ROS, parameters, robot, in this order, and ends it in the other
master       the ROS 1 master: registers a node of rospy again with the one that follows it
environment  checks the variables that tell programs of ROS 1 where the master and this computer
package      a ROS 1 package that `rosrun` and `roslaunch` find, without catkin and without a build
middleware   the middleware of ROS 1
connection   connections of rospy that wake no thread for a message
reconfigure  dynamic_reconfigure in ROS 1: a server without a generated configuration
===========  ======================================================================================
"""
