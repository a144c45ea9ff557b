"""Checks a robot's node of ROS 2, ours or anybody's, against the table of topics and services.

============  ===================================================================================
module        contents
============  ===================================================================================
listening     finds a robot on the network and listens to all of its topics for a while
check         checks a robot by all that was heard of it, row by row of the table. Pure
transforms    checks the tree of transforms, and that every frame is in it. Pure
endpoints     checks publishers, subscribers and services by the graph: types, quality of service
timing        checks when messages come, and their stamps. Pure
expectations  the expectations of a robot's topics
content       checks the fields of a message: numbers, quaternions, covariances, sizes. Pure
robots        finds the robot to check in a graph: by its name, its namespace, or as the only one
facts         the parts of a check
============  ===================================================================================
"""
