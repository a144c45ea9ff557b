"""A robot as a ROS node, over any middleware: topics, services, parameters, commands.

==================  ================================================================================
module              contents
==================  ================================================================================
start               the part of a node's start that is the same on every middleware
node                a robot as a ROS node, over any middleware
commands            commands from topics to the robot
command_order       order of commands from several publishers, and from one after a silence. Pure
services            the table of services, and their work
navigation          the navigation of a node: publishes map, place and way; takes starts and goals
goals               passes goals from topics on to the goal server, and tells of them
goal_list           the goals of one action server, by the rules of actionlib's protocol
navigation_topics   the table of topics of a node that has a map
laser_node          a laser range finder as a ROS node
updates             makes what topics are published from
publishing          publishes the topics of the table: each one when it is due, and has subscribers
topics              the table of topics
p2os_topics         topics that only p2os has
topic               a row of the table of topics
middleware          the part of a ROS middleware that nodes and clients need
clock               the time in stamps
parameter_reading   reads the parameters of a node as somebody has written them
parameters          the parameters of a node: what each means, and what follows from their values
laser_parameters    parameters of the laser range finder
driving_parameters  parameters of driving
parameter           a parameter of a node as one row
names               the names in all profiles
==================  ================================================================================
"""
