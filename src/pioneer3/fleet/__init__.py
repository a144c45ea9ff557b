"""The fleet: robots and their computers, described once in a file, and the work on all of them."""
