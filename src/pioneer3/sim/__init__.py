"""A simulated world whose robots speak ARCOS over a real socket."""
