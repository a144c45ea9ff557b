"""Navigation: maps from scans, where the robot is on them, and ways over them. No I/O, no clock.

================  ==================================================================================
module            contents
================  ==================================================================================
places            the places of a map that people send robots to
place_text        places as people write them: a name, or numbers
raster            the square cells that a map is divided into, and distances to walls in them
costs             the cost of driving over each place of a map, for one robot
planner           ways to a goal
follower          the velocity that takes a robot along its way
manoeuvre         manoeuvres
clearance         the last check of a velocity command: it moves no outline into walls or echoes
beams             a scan as arrays, in the frame of the robot
sightings         things that are not on the map: boxes, closed doors, people
echoes            echoes that neither the map, nor the laser, nor people in sight explain
clusters          echoes of a scan that no wall explains
mover             one thing that may move: where it is, how fast it goes, and whether it is a person
moving            people and other things that move
traffic           several robots on one map: who comes near to whom, and places to let others pass
estimate          the result of localization: where a robot is on the map, and how sure that is
localizer         finds a robot on a map of walls, by its laser or by its sonars
tracking          keeps track of a robot whose place is known roughly, by its laser or by its sonars
global_search     where on a map a robot may be, from one scan alone
hypotheses        poses of which any may be the right one
particles         poses as arrays, how odometry moves them, and particles
likelihood        how well scans fit a map of walls, and the poses at which they fit best
likelihood_sonar  how well the pings of sonars fit a map
frames            parts of a map: scans at poses, and the ways that were measured between them
matching          finds the pose from which a scan fits the scans before it
relocalization    finds the place of a scan that is nowhere near where odometry has it
loops             finds places again
pose_graph        the poses, edges and pieces of a map while loops are added to it
graph             poses from the ways that were measured between them
odometry          where odometry leads to, how far from there a robot may be, and its scale
mounting          finds out how far a laser is turned from where it is said to look
mapper            makes a map: poses of a robot, live, from scans and odometry
contradictions    finds where odometry contradicts the scans of a map
rendering         draws the map of a survey: which cells are free, and which are walls
changes           draws maps that were continued, and finds what has changed
frontiers         where a map ends: places from which a robot sees what is unknown
exploring         chooses the edge of a map that a robot looks at next, until none is left
logged            readings of logs, and scans that wait for the odometry of their time
carmen            reads logs of CARMEN, the format in which laser logs of robots are published
scan_log          reads scan logs of ARIA, `.2d`
settings          settings of navigation that a lab may tune
kernels           the inner loops of navigation
warm_up           compiles or loads all kernels, by navigating in a small room
__main__          compiles the kernels of navigation and keeps the result: `python -m pioneer3.nav`
================  ==================================================================================
"""
