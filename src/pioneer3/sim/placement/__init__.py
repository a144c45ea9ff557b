"""Who begins where: robots, their names, and free places for them."""
