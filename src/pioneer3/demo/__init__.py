"""The lab's robotDemo in a terminal: modes that know no screen, and two faces for them.

=======  =====================================================================================
module   contents
=======  =====================================================================================
start    starts the demo, on a screen or as lines
app      the demo as a full screen of a terminal, for 80 x 24 characters and more
view     texts and bars of the screen: the robot, the modes, the active mode, the flags
drawing  pictures to scale, made of characters: the robot, its echoes, its trail
plain    the demo as lines of text, for pipes and screen readers
program  the demo without a screen: modes, keys, and everything that must stop the robot
modes    the lab's thirteen modes and ARIA's two
mode     a mode of the demo: its description, and functions that know the robot, but no screen
columns  ARIA's columns: a header and a line under it, each column right-aligned in its width
=======  =====================================================================================
"""
