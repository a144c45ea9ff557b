"""ROS 1: a robot's or laser's node, and clients, by :mod:`pioneer3.ros.tcpros`: no ROS is needed.

===========  ======================================================================================
module       contents
===========  ======================================================================================
client       programs on ROS 1 that find robots and drive them by their topics, from any computer
start        starts the ROS 1 node: ROS, parameters, robot, in this order, and ends it in the other
environment  checks the variables that tell programs of ROS 1 where the master and this computer
package      a ROS 1 package that `rosrun` and `roslaunch` find, without catkin and without a build
arguments    the arguments of programs of ROS 1: names, remappings, private parameters, addresses
middleware   the middleware of ROS 1
rosout       the log of a node of ROS 1, and the services that set how much is logged
reconfigure  dynamic_reconfigure in ROS 1: a server without its package
===========  ======================================================================================
"""
