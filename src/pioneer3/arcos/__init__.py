"""The robot's protocol (ARCOS, P2OS, AROS), without I/O: bytes and the time in, bytes out."""
