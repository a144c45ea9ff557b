"""Robots on the other side of ROS topics: finding, reading and driving them.

=========  =================================================================================
module     contents
=========  =================================================================================
joining    joins a robot by its topics, on any middleware
snapshots  from the topics of one robot back to snapshots of it
robot      a robot on the other side of topics
graph      finds the robots in a ROS graph by the topics that nodes publish and subscribe to
phone      a phone that publishes its rates of turning, as keys of a keyboard
=========  =================================================================================
"""
