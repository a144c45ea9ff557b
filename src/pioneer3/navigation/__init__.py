"""A robot with a map: where it is, how it gets to places, and how maps are made.

==============  =================================================================================
module          contents
==============  =================================================================================
connect         connecting, with or without a map
blocking        the robot without `await`
notebook        notebooks: live views, and the stops that their cells need
picture         a robot as a notebook shows it: sonars, lasers, trail, map
navigator       a robot on a map: its state, ways, going to places
goals           goals, from the request to the end: the action server
localization    where it is, from its scans or echoes, and the mode that finds it out
last_place      where it was when a program ended
ways            ways that are planned anew
drives          drives along ways: planned anew, held up, given way
follow_way      the mode that drives along a way
recovery        its part for a robot that is held up: manoeuvres, and room for people
keep_clear      the limiter that is asked last: no outline into walls or echoes
traffic         robots of one program: frames, who travels where, who waits
group           formations of them
recording       the topics of a log about places, goals, ways and maps
map_builder     maps, while a robot drives or explores
map_logs        maps, from recordings and logs
log_files       logs, opened by their content, and names of other files
bag_logs        rosbags as logs
bag_frames      the frames of a bag: where its laser is, and whose motion is odometry
map_files       maps as files
map_update      a map that is continued, and what has changed on it
simulator       the map and the pose that a simulator tells
==============  =================================================================================

The methods themselves are in `nav`, without I/O.
"""
