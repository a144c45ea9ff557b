"""Finds and explains faults between this computer and a robot.

:func:`gather` collects :class:`LinkFacts`, :func:`diagnose` derives the findings from them.
"""

import asyncio
from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from typing import Final

from pioneer3.doctor.facts import Finding, Heard, Level, LinkFacts
from pioneer3.doctor.port_checks import check_adapter, check_answer, check_port
from pioneer3.doctor.ports import find_port
from pioneer3.doctor.probe_session import ProbeSession
from pioneer3.doctor.robot_checks import (
    check_checksums,
    check_config,
    check_reports,
    check_session,
    check_speed,
    check_state,
    check_type,
)
from pioneer3.errors import LinkError
from pioneer3.links import Link, open_link
from pioneer3.models import GivenModel, loaded_model
from pioneer3.robot.assemble import Assembler
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Snapshot


async def gather(
    url: str, *, baud: int | None = None, model: GivenModel = None, seconds: float = 3.0
) -> LinkFacts:
    """Return the facts about `url` after listening for `seconds`, at `baud` first.

    Raises:
        ConfigError: `url` names no port, or there is no such model.
    """
    model = loaded_model(model)
    port = await asyncio.to_thread(find_port, url)
    if port is not None and port.holders:  # a second host would disturb the first
        return LinkFacts(url=url, port=port)
    try:
        link = await open_link(url, baud=baud)
    except LinkError as error:
        return LinkFacts(url=url, port=port, refused=error)
    return await examine(link, seconds, LinkFacts(url=url, port=port), model)


async def examine(
    link: Link, seconds: float, known: LinkFacts, model: GivenModel = None
) -> LinkFacts:
    """Return the facts `known` with those found over `link`; the link is closed then."""
    session = ProbeSession(link, model=model)
    try:
        if await session.handshake():
            heard = await _listen(session, seconds)
            return replace(known, info=session.info, streaming=session.streaming, heard=heard)
        other_device = await session.other_device()
        return replace(
            known,
            closed=session.closed,
            streaming=session.streaming,
            other_device=other_device,
            heard_at=tuple(speed for speed in session.heard_at if speed is not None),
        )
    finally:
        await session.close()


async def _listen(session: ProbeSession, seconds: float) -> Heard:
    """Return a summary of the reception from now on; earlier reports count for readings only.

    A CONFIG whose checksum is always wrong is therefore not counted as a fault of the cable.
    """
    clock = asyncio.get_running_loop().time
    before, began, reader = len(session.sips), clock(), session.reader
    packets, bad, skipped = reader.packets, reader.bad_checksums, reader.bytes_skipped
    await session.listen(seconds)
    stamps = [began, *(stamp for stamp, _ in session.sips[before:]), clock()]
    return Heard(
        seconds=max(stamps[-1] - began, 1e-3),
        reports=len(stamps) - 2,
        longest_gap=max(later - earlier for earlier, later in pairwise(stamps)),
        packets=reader.packets - packets,
        bad_checksums=reader.bad_checksums - bad,
        bytes_skipped=reader.bytes_skipped - skipped,
        sonars=frozenset(r.number for _, sip in session.sips for r in sip.sonar),
        snapshot=_last_snapshot(session, session.info),
        config_trusted=session.config_trusted,
        ended=session.failure or ("the other end hung up" if session.closed else None),
    )


def _last_snapshot(session: ProbeSession, info: RobotInfo | None) -> Snapshot | None:
    if info is None or not session.sips:
        return None
    assembler = Assembler()
    assembler.session_opened(info.model)
    stamp, sip = session.sips[-1]
    return assembler.assemble(sip, stamp, model=info.model, config=info.config)


CHECKS: Final = (
    check_port,
    check_adapter,
    check_answer,
    check_speed,
    check_session,
    check_type,
    check_config,
    check_reports,
    check_checksums,
    check_state,
)
"""The checks in the order of repair, from the plug to the wheels."""


def diagnose(facts: LinkFacts) -> tuple[Finding, ...]:
    """Return the findings in the order of repair."""
    return tuple(finding for check in CHECKS for finding in check(facts))


def exit_code(findings: Iterable[Finding]) -> int:
    """Return 0 unless something failed, else the code of the first failure."""
    return next((f.code for f in findings if f.level is Level.FAIL), 0)
