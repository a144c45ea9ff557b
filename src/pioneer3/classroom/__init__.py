"""A class of students with a robot each: seats, permissions, runs, and files for their computers.

==========  ================================================================================
module      contents
==========  ================================================================================
roster      students and their robots
runs        runs that are handed in
wheel       the wheel of this package, as it runs here
wheelhouse  wheels of what it needs, for laptops without internet
downloads   all files that a class hands out
==========  ================================================================================
"""
