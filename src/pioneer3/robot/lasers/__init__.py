"""Laser range finders at the computer, each on a link of its own.

=============  ==============================================================================
module         contents
=============  ==============================================================================
driver         keeps one laser connected, and hands out its scans
mounting       pose and masked sectors; turns scans of the laser into scans of the robot
search         finds the protocol of the laser at a link
spec           `--laser` and `--laser-pose` as people write them
=============  ==============================================================================
"""
