"""The robot in ROS: messages, nodes and clients over any middleware, and the edge to ROS 1.

============  ====================================================================================
module        contents
============  ====================================================================================
ros1          ROS 1: a robot's or laser's node, and clients
checks        checks a robot's node of ROS 2
bag           bags of ROS 1 and ROS 2, made of a log
bridge        a bridge between a network of ROS 1 and one of ROS 2, by a table of topics
tcpros        a node of ROS 1 without ROS 1
addresses     the addresses of a node of ROS 1: of the master, and where others find this computer
ament         the ROS 2 package that `ros2 run` and `ros2 launch` find, without a build
ros2          ROS 2 over rclpy, DDS or Zenoh
rclpy         ROS 2 by the installation of ROS on this computer: any middleware, by rclpy
dds           ROS 2 over DDS, by Cyclone DDS, without a ROS installation
client        robots on the other side of ROS topics: finding, reading and driving them
zenoh         ROS 2 over Zenoh, on the wire as rmw_zenoh_cpp
encoding      messages as bytes of ROS 1 and ROS 2
definitions   messages of ROS 1 of packages that nobody need install
typestore     messages of a type system of rosbags, that of ROS 1 or one of ROS 2
node          a robot as a ROS node, over any middleware: topics, services, parameters, commands
messages      readings to messages and back. Needs no ROS: message classes are handed in
installation  the parts of an installed ROS package that are the same in ROS 1 and ROS 2
============  ====================================================================================
"""
