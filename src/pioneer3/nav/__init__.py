"""Navigation: maps from scans, where the robot is on them, and ways over them. No I/O, no clock."""
