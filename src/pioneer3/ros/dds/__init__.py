"""ROS 2 over DDS, by Cyclone DDS, without a ROS installation.

=========  =====================================================================================
module     contents
=========  =====================================================================================
backend    a node of ROS 2 as a participant of DDS
entities   the objects of Cyclone DDS that belong to one participant
samples    types of Cyclone DDS whose samples are serialized bytes: no codec of the library runs
endpoints  publishers and subscribers of a participant, as ROS 2 has them
settings   settings of Cyclone DDS, as ROS 2's peers need them
sockets    keeps DDS to the network interfaces that were asked for
services   services as rmw_cyclonedds_cpp has them: two topics, and a header before each message
discovery  the graph of ROS 2 over DDS
=========  =====================================================================================
"""
