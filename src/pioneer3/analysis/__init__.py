"""Looks at logs: the readings of a run as objects and as arrays.

===============  ==============================================================================
module           contents
===============  ==============================================================================
why              the reason that a robot stood or moved at a time
twin             errors of a robot's odometry, and where its simulated twin ends a drive
stats            figures of a run: way, time under way, stops, latencies
anonymous        a log without names, addresses and serial numbers
anonymous_bytes  its part for the bytes of a robot, in frames that stay valid
picture          the way and the curves of a run as a picture, by matplotlib
curves           the way and the curves of a run, to be drawn
open_log         a log that is open: its robots, its times, its messages
arrays           messages as arrays with named columns
===============  ==============================================================================
"""
