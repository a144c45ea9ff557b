"""A robot's port for a network: one host has the robot, the others watch and may stop it.

==========  ===============================================================================
module      contents
==========  ===============================================================================
bridge      one robot, opened when the first host connects, and the hosts that share it
relay       the rules of a bridge between hosts and one robot
robot_side  the bridge's session with the robot. No I/O: bytes and the time in, bytes out
guard       decides which packets of the host that has the robot reach it. No I/O, no clock
ports       connections of hosts: over TCP, and from within this process
client      one host of a bridge: the robot's side of its handshake. No I/O, no clock
braking     stops of the bridge itself: repeated until the robot's reports confirm them
==========  ===============================================================================
"""

from pioneer3.bridge.bridge import Bridge

__all__ = ["Bridge"]
