"""The composition root: a connected robot, and who may drive it.

============  =====================================================================================
module        contents
============  =====================================================================================
connect       connecting, and every way of leaving
robot         `Robot`, as programs see it
recording     the log of a robot: snapshots and scans, commands, decisions
shadow        compares a robot with its twin as it drives
parting       where the two part, and the cause that fits best
twin          the twin of a robot: a simulated one that obeys the bytes of a host
recorded_wire the connections of a link in a log, opened again
verification  today's driver over the bytes of a log, compared with what was seen then
driven        the commands and snapshots of a robot that programs get, at a cable or over topics
arbiter       asks all actions, sends one velocity command, tells the reason to stand still
motions       moves, turns and modes that are waited for
signals       signals end a program, and stop its robot
facade        an asynchronous object without `await`
blocking      connections without `await`, and lasers
============  =====================================================================================
"""
