"""Collects the facts: looks at the port, talks to what is there, listens. Moves nothing."""

import asyncio
from dataclasses import replace
from itertools import pairwise

from pioneer3.errors import LinkError
from pioneer3.links import Link, open_link
from pioneer3.robot.assemble import Assembler
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.runtime.conversation import Conversation
from pioneer3.runtime.diagnosis.facts import Facts, Heard
from pioneer3.runtime.ports import find_port
from pioneer3.state import Snapshot


async def gather(url: str, *, baud: int | None = None, seconds: float = 3.0) -> Facts:
    """Return what there is to know about `url` after listening for `seconds`.

    Raises:
        ConfigError: `url` names no port.
    """
    port = await asyncio.to_thread(find_port, url)
    if port is not None and port.holders:  # two hosts on one robot would be worse than none
        return Facts(url=url, port=port)
    try:
        link = await open_link(url, baud=baud)
    except LinkError as error:
        return Facts(url=url, port=port, refused=error)
    return await interview(link, seconds, Facts(url=url, port=port))


async def interview(link: Link, seconds: float, known: Facts) -> Facts:
    """Return the facts `known`, and those that `link` leads to; the link is closed then."""
    conversation = Conversation(link)
    try:
        if await conversation.meet():
            heard = await _listen(conversation, seconds)
            return replace(
                known, info=conversation.info, streaming=conversation.streaming, heard=heard
            )
        stranger = await conversation.stranger()
        return replace(
            known,
            closed=conversation.closed,
            streaming=conversation.streaming,
            stranger=stranger,
            heard_at=tuple(speed for speed in conversation.heard_at if speed is not None),
        )
    finally:
        await conversation.leave()


async def _listen(conversation: Conversation, seconds: float) -> Heard:
    """Return what comes from now on; the reports before it count for the readings only."""
    clock = asyncio.get_running_loop().time
    before, began = len(conversation.sips), clock()
    await conversation.listen(seconds)
    stamps = [began, *(stamp for stamp, _ in conversation.sips[before:]), clock()]
    return Heard(
        seconds=max(stamps[-1] - began, 1e-3),
        reports=len(stamps) - 2,
        longest_gap=max(later - earlier for earlier, later in pairwise(stamps)),
        packets=conversation.packets,
        bad_checksums=conversation.bad_checksums,
        bytes_skipped=conversation.bytes_skipped,
        sonars=frozenset(r.number for _, sip in conversation.sips for r in sip.sonar),
        snapshot=_last_snapshot(conversation, conversation.info),
        config_trusted=conversation.config_trusted,
        ended=conversation.failure or ("the other end hung up" if conversation.closed else None),
    )


def _last_snapshot(conversation: Conversation, info: RobotInfo | None) -> Snapshot | None:
    if info is None or not conversation.sips:
        return None
    assembler = Assembler()
    assembler.session_opened(info.model)
    stamp, sip = conversation.sips[-1]
    return assembler.assemble(sip, stamp, model=info.model, config=info.config)
