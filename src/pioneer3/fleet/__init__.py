"""The fleet: robots and their computers, described once in a file, and the work on all of them.

============  ======================================================================================
module        contents
============  ======================================================================================
inventory     the fleet file: robots, their computers, the operator's computer, and groups of robots
checks        the checks of a fleet file that its tables do not make
screen        driving a fleet on a full screen of a terminal, for 80 x 24 characters and more
drive         drives the robots of a fleet with one keyboard; it knows no screen
group         a mode of the robots that one keyboard drives: started by a key, ended by a stop
places        the places of a fleet's robots: a simulator tells them, or they were lined up
drive_table   the table of robots that are driven, column by column; each has words for its colours
columns       the table of a fleet, column by column: the contents of each, and its meaning
live          the state of all robots now
doctor        gathers the facts about the computers of a fleet, and derives the findings from them
host_checks   findings about a robot's computer, from its facts
key           keys in place of passwords
stop          stops all robots of a fleet at once, and tells which have confirmed it
members       the robots that one operator drives
ssh_config    short ways to the robots' computers: an include file of ssh, and aliases of a shell
simulated     the robots of a fleet file as simulated ones
hosts         the names of a fleet in /etc/hosts: entries for all its computers, and mistakes there
edit          changes of files that belong to people
discovery     finds robots, simulators, serial bridges, and computers that may be on robots
announce      robots and pages that others reach are announced by DNS-SD (RFC 6763, zeroconf)
deploy        installs this package on robots' computers
unit          the systemd unit that runs pioneer3 from when a computer is switched on. Pure
service       the service of this computer: installed, looked at, removed
ros_graph     questions to a ROS 1 graph without ROS
reach         how this computer reaches a robot of the fleet: by its port, if that is one for others
host_facts    the facts that a robot's computer tells: one question over ssh, and its answer as data
copy          files to and from many computers: whole or not at all
run           work on many computers at once
ssh           logging in on a robot's computer over ssh, and the meaning of failures
ssh_settings  settings of `ssh` for a robot's computer, from `~/.ssh/config`
spec          the contents of a fleet file: robots, their computers, the operator's, groups; frozen
network       a network of ROS 2 in a fleet file: its keys, and the checks of them
bundle        the package and all that it needs, for a robot without internet
============  ======================================================================================
"""
