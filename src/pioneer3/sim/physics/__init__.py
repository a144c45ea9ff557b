"""Robots with mass, motors and tires among walls with height, by MuJoCo.

========  ====================================================================================
module    contents
========  ====================================================================================
dynamics  moves robots by the torque of their motors, and boxes by what pushes them
sensing   sonars, lasers and bumpers in three dimensions
rays      rays among the geoms of a scene, and all that they need to know of robots and things
ground    heights of the ground, by rays from above, and how things stand on it
motors    the motors of all robots
scene     the parts of a world for MuJoCo
elements  the solids of a world as geoms of MuJoCo, each named after its table and number
renderer  the process that renders pictures: it alone loads OpenGL
colors    colours of a world's geoms: a camera and a colour tracker can tell them apart
========  ====================================================================================
"""
