"""The simulator on the network and in time.

===============  ===============================================================================
module           contents
===============  ===============================================================================
start            builds a simulator and lets it run beside the caller
simulation       the simulator on the network
running          a running simulator: its robots, and the methods that change its world
port             the port of one simulated robot: hosts connect to it, one at a time
clients          hosts that connect to a simulated robot
listeners        listening sockets and pseudo terminals, through which hosts connect
pacer            the speed of simulated time
faults           faults of the cable between a host and its robot, on demand and repeatable
trackers         an ACTS server for each simulated robot
camera_ports     the cameras of a simulation
picture_process  the process that renders the pictures of all cameras of a simulation
camera           a simulated camera on a robot: its pictures, and those who look at them by HTTP
laser_ports      the lasers of a simulation
laser            a simulated laser range finder on a robot: its mirror, its protocol, its ports
laser_hosts      hosts that connect to a simulated laser
===============  ===============================================================================
"""

from pioneer3.sim.server.simulation import Simulation

__all__ = ["Simulation"]
