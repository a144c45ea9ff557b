"""Byte pipes between a host and a robot: serial, TCP, in memory, pseudo terminals, recordings.

======  ===============================================================================
module  contents
======  ===============================================================================
urls    opens links by URL or path
hosts   addresses of this computer and of others, and their form in URLs
tap     recording the bytes of a link, one line a chunk, and playing them back
serial  serial ports, real and pseudo, and the reasons for a failure to open
stream  links over a pair of asyncio streams
base    the interface of a byte pipe between a host and a robot
memory  a null-modem cable in memory, with faults, for tests and the embedded simulator
======  ===============================================================================
"""

from pioneer3.links.base import Link, Opener
from pioneer3.links.urls import open_link, opener

__all__ = ["Link", "Opener", "open_link", "opener"]
