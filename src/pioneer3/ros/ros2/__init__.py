"""ROS 2 over rclpy, DDS or Zenoh.

==================  ===============================================================================
module              contents
==================  ===============================================================================
sessions            robots on several networks of ROS 2 at once
client              programs on ROS 2 that find robots and drive them by their topics
start               starts the ROS 2 node
managed             the robot of a managed node: connected when configured, driven when active
requests            requests to a robot's node besides velocities
middleware          the middleware of ROS 2 over any backend
arguments           the arguments of ROS 2
parameter_files     values and files of parameters in YAML
remapping           remapping rules of ROS 2: `node:rostopic://match:=replacement`
lifecycle           the life cycle of a managed node: its states, transitions and services
senders             the publishers of the messages that a node receives
parameter_services  the parameter services of a node, and the content of `/parameter_events`
mismatches          finds endpoints of other nodes that cannot talk to ours
network             the choice of a backend
types               messages of one distribution: empty ones to fill, and their serialized form
distros             the distributions of ROS 2, as far as they differ on the wire
names               names in ROS 2: namespaces, private names, and names that come from the network
state               the state of a robot from a few of its topics, for those who only look
backend             the seam between ROS 2 and the wire
==================  ===============================================================================
"""
