"""Finds robots on ports, and explains faults between this computer and a robot.

=============  =================================================================================
module         contents
=============  =================================================================================
probe          probes ports, side by side, for the devices at the other ends
watch          monitors the line to a connected robot with the checks of the diagnosis
udev           rules for udev that give robots and lasers names that stay. Pure
diagnose       finds and explains faults between this computer and a robot
port_checks    findings about the connection: the port, the adapter, the device that answers
probe_session  a session that probes the device at the end of a link
lasers         asks ports for a laser range finder, as a driver would, and changes nothing there
robot_checks   findings about the robot that answered, and about the line to it
facts          the parts of a diagnosis: facts, and the findings derived from them
recognition    recognises devices that are not Pioneer robots by the bytes they send. Pure
ports          serial ports of this computer, from /sys, /proc and udev, without sending a byte
decoding_link  a link that decodes every report on its way to a host
=============  =================================================================================
"""
