"""Bags of ROS 1 and ROS 2, made of a log: with the topics that the node publishes.

==========  ========================================================================================
module      contents
==========  ========================================================================================
convert     writes the robots of a log to a bag
robots      the robots of a log: their names, models and lasers
player      publishes what the node of a robot would have published
navigation  publishes the map of a log, the robot's place on it and its way
outlet      stands in for a middleware: what a node publishes goes to a bag
bags        bags while they are written
types       messages as bytes in bags
==========  ========================================================================================
"""
