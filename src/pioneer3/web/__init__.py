"""The live page: a server for browsers, and what it serves."""
