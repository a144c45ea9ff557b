"""Every report that passes on a link, decoded, whoever it is meant for."""

import asyncio
from collections.abc import Callable

from pioneer3.arcos.packet import PacketReader
from pioneer3.arcos.reports import Report, from_payload
from pioneer3.links import Link

Hearer = Callable[[float, Report], None]
"""Takes the time of arrival [s, monotonic] and a report."""


class OverheardLink:
    """A host's link that tells every report to a hearer; same contract as the link inside."""

    def __init__(self, link: Link, hearer: Hearer) -> None:
        self.url = link.url
        self.speeds = link.speeds
        self._link = link
        self._hearer = hearer
        self._reader = PacketReader()
        self._clock = asyncio.get_running_loop().time

    async def read(self) -> bytes:
        """Read from the link inside, and listen."""
        data = await self._link.read()
        now = self._clock()
        for payload in self._reader.feed(data, now):
            self._hearer(now, from_payload(payload))
        return data

    async def write(self, data: bytes) -> None:
        """Write to the link inside."""
        await self._link.write(data)

    async def set_speed(self, baud: int) -> None:
        """Change the speed of the link inside."""
        await self._link.set_speed(baud)

    async def close(self) -> None:
        """Close the link inside."""
        await self._link.close()
