"""Calibration of odometry: how wrong a robot's wheels are, and with which numbers that is mended.

===========  ============================================================================
module       contents
===========  ============================================================================
umbmark      errors of a square driven both ways, by Borenstein and Feng
track        ways and turns as the wheels count them, and the poses that they make
ends         how a run ended, by a tape, by echoes or by scans
estimate     the correction that fits all runs best, and whether it is better than chance
course       drives the legs of a step, and keeps what wheels, sonars and laser say
echoes       true turns by what sonars hear
scans        where a laser was at each stand, and how late its scans are
steps        what is driven, and what is measured
calibration  the steps that were measured, and what they tell together
procedure    the steps of one robot in turn, and the numbers for its own file
own_file     writes the numbers into the robot's own file
===========  ============================================================================
"""
