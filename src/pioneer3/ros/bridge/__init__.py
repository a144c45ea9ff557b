"""A bridge between a network of ROS 1 and one of ROS 2, by a table of topics.

==========  ==================================================================================
module      contents
==========  ==================================================================================
start       starts a bridge: its table, both networks, in this order, and ends it in the other
bridge      the bridge: its rows, the other bridges and publishers beside it, and its end
sources     the topics that messages come from
services    the services of the robot on the side that its node is not on
relay       the way of one topic's messages from one network to the other
guard       velocity commands over a bridge
topic_file  further rows of a bridge, from a file or the command line
rows        the table of a bridge: its rows from the table of topics of the robot's node. Pure
conversion  messages of ROS 1 to messages of ROS 2, and back, field by field. Pure
==========  ==================================================================================
"""
