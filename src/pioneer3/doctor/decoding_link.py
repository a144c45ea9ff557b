"""A link that decodes every report on its way to a host."""

import asyncio
from collections.abc import Callable
from enum import Flag

from msgspec.structs import fields

from pioneer3.arcos.packet import PacketReader
from pioneer3.arcos.reports import Report, SonarReading, from_payload, to_payload
from pioneer3.links import Link

Listener = Callable[[float, Report], None]
"""Takes the time of arrival [s, monotonic] and a report."""


class DecodingLink:
    """A host's link that passes every report to a listener; same contract as the link inside."""

    def __init__(self, link: Link, listener: Listener) -> None:
        self.url = link.url
        self.speeds = link.speeds
        self.round_trip = link.round_trip
        self._link = link
        self._listener = listener
        self._reader = PacketReader()
        self._clock = asyncio.get_running_loop().time

    async def read(self) -> bytes:
        """Read from the link inside, and pass the reports on."""
        data = await self._link.read()
        now = self._clock()
        for payload in self._reader.feed(data, now):
            self._listener(now, from_payload(payload))
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


def described(report: Report) -> str:
    """Return `report` in one line: its id, its class and the fields that are set."""
    shown = {field.name: getattr(report, field.name) for field in fields(report)}
    is_set = {name: value for name, value in shown.items() if value not in (None, b"", ())}
    carried = " ".join(f"{name}={_shown(value)}" for name, value in is_set.items())
    return f"{to_payload(report)[0]:#04x} {type(report).__name__} {carried}".rstrip()


def _shown(value: object) -> str:
    match value:
        case bytes():
            return value.hex()
        case Flag():
            return "+".join(str(flag.name) for flag in value) or "0"
        case tuple() if all(isinstance(each, SonarReading) for each in value):
            return ",".join(f"{each.number}:{each.range_raw}" for each in value)
        case str():
            return repr(value)
        case _:
            return str(value)
