"""A node of ROS 1 without ROS 1: the protocols of its topics and services, and of its master.

==========  ===========================================================================
module      contents
==========  ===========================================================================
node        a node of ROS 1
subscriber  a subscription to a topic of ROS 1: a connection to each of its publishers
services    services of ROS 1: offered, and called
publisher   a publisher on a topic of ROS 1
master      the master and other nodes by XML-RPC, called with a limit of time
types       message types of ROS 1 Noetic: definitions and codec of rosbags
liveness    which nodes respond: one that was killed stays registered, and one may hang
framing     frames and headers of TCPROS
answers     answers of the master and of other nodes
==========  ===========================================================================
"""
