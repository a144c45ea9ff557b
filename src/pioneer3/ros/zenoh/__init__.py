"""ROS 2 over Zenoh, on the wire as rmw_zenoh_cpp.

===========  ======================================================================================
module       contents
===========  ======================================================================================
backend      a node of ROS 2 over Zenoh, for peers with rmw_zenoh_cpp
presence     whether there is a router, and the reason if there is none
settings     settings of a Zenoh session: endpoints, TLS and login, secrets in files only; a router
config_file  configuration files of Zenoh: which settings they have, and which secrets
graph        the graph of nodes, from liveliness tokens
endpoints    publishers, subscribers and services of a Zenoh session, as ROS 2 has them
keys         keys, tokens and attachments of ROS 2 over Zenoh, as rmw_zenoh_cpp has them
===========  ======================================================================================
"""
