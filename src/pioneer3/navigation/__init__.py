"""A robot with a map: where it is, how it gets to places, and how maps are made.

==============  =================================================================================
module          contents
==============  =================================================================================
connect         connecting, with or without a map
simulator_map   the map that a simulator names
navigator       a robot on a map: its state, ways, going to places
localization    where it is, from its scans or echoes
ways            ways that are planned anew
drives          drives along ways: planned anew, held up, given way
follow_way      the mode that drives along a way
going_aside     its part that makes room for others
lining_up       its part that turns the robot to its way
look_around     the mode that finds out where the robot is
traffic         robots of one program: frames, who travels where, who waits
group           formations of them
explore         the mode that looks where a map ends
map_builder     maps, while a robot drives
map_logs        maps, from recordings and logs
map_files       maps as files
true_pose       the pose that a simulator tells
==============  =================================================================================

The methods themselves are in `nav`, without I/O.
"""
