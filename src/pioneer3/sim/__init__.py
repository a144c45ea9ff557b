"""A simulated world whose robots speak ARCOS over a real socket.

=============  =====================================================================================
module         contents
=============  =====================================================================================
server         the simulator on the network and in time
firmware       the robot's controller: the only part of the simulator that knows ARCOS
accessories    accessories of a robot's controller; none of them reads a clock
eye            the people, boxes and robots around a robot, as its camera sees them: blobs of colour
laser_scanner  a laser range finder on a robot: its mirror turns while the robot drives
world          the simulated world: walls, robots, obstacles, time
dynamics       how the robots and boxes of a world move: on a plane, or as bodies with mass
sonar          the sonars of all robots of a world
map_convert    reads, checks and converts maps and worlds by their names, for `pioneer3 map`
map_check      checks a map or world file
physics        robots with mass, motors and tires among walls with height, by MuJoCo
sensing        measurements of robots' sensors, without errors: on a plane, or in three dimensions
body           one simulated robot: its true pose, its odometry, its drive, its energy
motion         a robot's drive as the firmware sees it: two axes and the motors' power
obstacles      boxes, and people on their paths: the things in a world that may move, beside robots
realism        errors of a simulated robot, as large as those of a real one
kernels        the simulator's inner loops: motion, rays, fans and footprints of all robots at once
raycast        range to the nearest wall along each ray. Arrays in, arrays out
sensors        sensors of a body
placer         starts of robots: a home, a given pose, beside the map or anywhere
free_space     the cells where a disc fits, and the places for robots of one size among them
collision      a robot's rectangle: what it collides with, and the bumper segments that are pressed
worldfile      worlds in TOML: a map with robots, boxes, walls, places and people
relief         the third dimension of a world
equipment      the accessories of a robot: those it has, and the choices of people about them
=============  =====================================================================================
"""
