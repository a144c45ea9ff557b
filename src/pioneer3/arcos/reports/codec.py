"""Reports to payloads and back: reading and writing again gives the same bytes."""

from collections.abc import Mapping
from functools import cache
from typing import ClassVar, Final

from pioneer3.arcos.layout import Report, layout, pack, unpack
from pioneer3.arcos.reports import devices, session, simulators, sip
from pioneer3.arcos.reports.sip import SIP_NUMBERS, Sip, read_sip, write_sip
from pioneer3.arcos.wire import U8, PacketId, Rest


class UnknownReport(Report, frozen=True):
    """A packet without a class here, or with data that do not decode.

    `number` is `None` if there was not a single byte.
    """

    ID: ClassVar[int] = -1
    number: U8 | None = None
    data: Rest = b""


EXACT: Final[frozenset[type[Report]]] = frozenset(
    {simulators.SimLaser, simulators.SimLaserExtended, simulators.SimStat}
)
"""Reports of which nothing can get lost, so that none is written to see it: a simulator sends them
10 to 60 times a second."""


@cache
def numbers(cls: type[Report]) -> tuple[int, ...]:
    """Return the ids of `cls`."""
    if cls is Sip:
        return tuple(SIP_NUMBERS)
    first = layout(cls)[0].kind
    return first.choices if isinstance(first, PacketId) else (cls.ID,)


ALL: Final[tuple[type[Report], ...]] = tuple(
    sorted(
        (
            member
            for module in (session, sip, devices, simulators)
            for name in module.__all__
            if hasattr(member := getattr(module, name), "ID")
        ),
        key=lambda cls: len(numbers(cls)),
    )
)
"""Every report class but :class:`UnknownReport`; what has an id of its own comes first."""


@cache
def _meanings() -> Mapping[int, tuple[type[Report], ...]]:
    """Return the classes that may stand behind each id."""
    ids = sorted({number for cls in ALL for number in numbers(cls)})
    return {number: tuple(cls for cls in ALL if number in numbers(cls)) for number in ids}


@cache
def _carries_number(cls: type[Report]) -> bool:
    """Whether the id is a field of the report rather than fixed by its class."""
    return cls is UnknownReport or isinstance(layout(cls)[0].kind, PacketId)


def to_payload(report: Report) -> bytes:
    """Return id and data of `report`; CommandError for a value that does not fit into its field."""
    if isinstance(report, Sip):
        return write_sip(report)
    number = b"" if _carries_number(type(report)) else bytes([report.ID])
    return number + pack(report)


def from_payload(payload: bytes) -> Report:
    """Return the report in `payload`; never raises.

    For every byte string, `to_payload(from_payload(payload)) == payload`: a packet of which
    something would be lost is an :class:`UnknownReport`.
    """
    if not payload:
        return UnknownReport()
    for cls in _meanings().get(payload[0], ()):
        try:
            if cls is Sip:
                return read_sip(payload)
            report = unpack(cls, payload if _carries_number(cls) else payload[1:])
        except (EOFError, ValueError):
            continue
        if cls in EXACT or to_payload(report) == payload:
            return report
    return UnknownReport(payload[0], payload[1:])
