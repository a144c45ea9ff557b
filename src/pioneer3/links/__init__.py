"""Byte pipes between a host and a robot: serial, TCP, in memory, pseudo terminals, recordings."""

from pioneer3.links.base import Link, Opener
from pioneer3.links.urls import open_link, opener

__all__ = ["Link", "Opener", "open_link", "opener"]
