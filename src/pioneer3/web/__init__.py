"""The live page: its server, its messages, its HTTP API, and its files."""
