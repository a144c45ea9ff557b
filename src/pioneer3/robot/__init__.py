"""The driver: sessions, limits, snapshots, reconnecting.

===============  ===================================================================================
module           contents
===============  ===================================================================================
supervisor       keeps one robot connected
session          one session: makes ARCOS commands of the pilot's motion, and snapshots of reports
pilot            decides the motion of a robot from velocity commands and snapshots
limits           limits that every velocity command passes last; `send_unsafe` goes past them
correction       twists as a controller with wrong odometry has to be told
explain          the reason that the robot stands still: a kind, and one sentence
assemble         turns reports into snapshots
poses            the robot's pose at any time of the last seconds, from its odometry
reports          passes the robot's reports on to subscribers; no subscriber can delay the driver
report_requests  requests for reports that the robot sends only when asked. No I/O, no clock
devices          the devices of a robot besides wheels and sonars, each used in SI units
config_table     meaning and group of each field of CONFIG, from which every table of CONFIG is made
config_backup    backups of CONFIG as files, and the commands that restore what a host may set
lasers           laser range finders at the computer, each on a link of its own
camera_driver    reads one MJPEG camera on the network while its pictures are wanted
===============  ===================================================================================
"""
