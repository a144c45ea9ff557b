"""Places for robots: footprints, free space, and starts."""
