"""Frames, links and shapes of a robot, from its model.

======  ======================================================================================
module  contents
======  ======================================================================================
urdf    a robot as a URDF: links, joints, boxes and cylinders, all from its model
mjcf    a robot as MJCF, the format of MuJoCo
sdf     a robot as SDF 1.9, the format of Gazebo: links, wheels that drive, and sensors
xml     numbers, pieces of XML and inertias that all formats of a description write alike
solids  solids of a robot's links: boxes and cylinders, from its model. Needs no ROS
tree    the tree of frames on a robot: the one source of URDF, static and moving transforms
gazebo  names of Gazebo's plug-ins and messages, and of the topics between it and ROS, as data
======  ======================================================================================
"""
