"""The addresses of a node of ROS 1: of the master, and where others find this computer."""

import asyncio
import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Final
from urllib.parse import urlsplit

from pioneer3.errors import ConfigError
from pioneer3.links.hosts import address_towards, is_address, is_own

PORT: Final = 11311
LOCAL: Final = "127.0.0.1"
LOOPBACK: Final = {"localhost", LOCAL, "::1"}
ANYWHERE: Final = "0.0.0.0"
AGAIN: Final = 1.0
"""Pause between two attempts to find a master [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Addresses:
    """Addresses of the master, of this computer for others, and to listen on."""

    master: str
    host: str
    bind: str


def addresses(master: str | None, environment: Mapping[str, str] = os.environ) -> Addresses:
    """Return the addresses by an option, or the variables that all of ROS 1 goes by.

    Without an option the master is that of ROS_MASTER_URI, else on this computer. With a master on
    this computer nothing listens beyond it, unless ROS_IP or ROS_HOSTNAME says so. Raises
    ConfigError if the address is none, or no way leads there.
    """
    uri = master or environment.get("ROS_MASTER_URI") or f"http://{LOCAL}:{PORT}"
    parts = urlsplit(uri)
    if parts.scheme != "http" or not parts.hostname:
        raise ConfigError(f"the ROS master is at an address such as http://robot:11311, not {uri}")
    if name := environment.get("ROS_HOSTNAME"):
        return Addresses(master=uri, host=name, bind=LOCAL if name in LOOPBACK else ANYWHERE)
    if own := environment.get("ROS_IP"):
        # behind a router this computer does not have the address by which others find it
        here = is_address(own) and is_own(own)
        return Addresses(master=uri, host=own, bind=own if here else ANYWHERE)
    if parts.hostname in LOOPBACK:
        return Addresses(master=uri, host=LOCAL, bind=LOCAL)
    try:
        own = address_towards(parts.hostname)
    except OSError as error:
        problem = f"no way leads to the ROS master's computer {parts.hostname}: {error}"
        raise ConfigError(problem) from error
    return Addresses(master=uri, host=own, bind=own)


async def wait_for_master(uri: str, tell: Callable[[str], None]) -> None:
    """Return as soon as something listens at `uri`; `tell` why that takes time."""
    address = urlsplit(uri)
    told = False
    while True:
        with suppress(OSError, TimeoutError):
            async with asyncio.timeout(AGAIN):
                _, writer = await asyncio.open_connection(address.hostname, address.port or PORT)
            writer.close()
            return
        if not told:
            tell(f"waits for a ROS master at {uri}: start roscore")
            told = True
        await asyncio.sleep(AGAIN)
