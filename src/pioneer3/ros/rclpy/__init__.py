"""ROS 2 by the installation of ROS on this computer: any middleware, by rclpy.

===========  ===============================================================================
module       contents
===========  ===============================================================================
backend      the backend over rclpy, for computers where ROS 2 is installed
taking       takes messages from rclpy as `rclpy.wait_for_message` does, without an executor
graph        the graph of nodes, by the graph functions of a node of rclpy
endpoints    publishers and subscribers of rclpy, whose messages are bytes
definitions  the generated classes of messages and services
===========  ===============================================================================
"""
