"""Places for robots: footprints, free space, starts, and straight paths."""
