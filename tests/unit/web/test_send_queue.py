"""What a visitor is told who is slower than the news. Virtual time."""

import asyncio
from collections.abc import MutableMapping
from itertools import pairwise
from typing import Any

from pioneer3.web.broadcast import GATHER, PERIOD, FrameChannel
from pioneer3.web.client import MOST_ANSWERS, PATIENCE, SendQueue
from pioneer3.web.messages import Pong
from tests.unit.web.browser import Browser, Product, product


class Slow(Browser):
    """A browser that takes a message only while it is awake."""

    def __init__(self, the: Product) -> None:
        super().__init__(the.app)
        self.awake = asyncio.Event()
        self.awake.set()
        self.hung_up: list[tuple[int, str]] = []
        self._scope["state"] = {"hang_up": lambda code, why: self.hung_up.append((code, why))}

    async def _send(self, message: MutableMapping[str, Any]) -> None:
        await self.awake.wait()
        await super()._send(message)


async def test_who_was_slow_goes_on_with_the_newest_and_has_missed_the_rest() -> None:
    async with product() as the, Slow(the) as ann, Browser(the.app) as bob:
        await asyncio.sleep(1.0)
        ann.awake.clear()
        await asyncio.sleep(5.0)
        heard = len(ann.snapshots())
        ann.awake.set()
        await asyncio.sleep(0.001)
        sequences = [snapshot["sequence"] for snapshot in ann.snapshots()]
        newest = bob.snapshot["sequence"]
        assert len(sequences) <= heard + 2  # the one in flight, and the newest
        assert sequences[-1] == newest
        every = [snapshot["sequence"] for snapshot in bob.snapshots()]
        assert every == list(range(every[0], every[0] + len(every)))


async def test_a_page_that_takes_nothing_still_stops_the_robot() -> None:
    async with product() as the, Slow(the) as ann, Browser(the.app) as bob:
        driving = asyncio.ensure_future(bob.keep_driving(0.3, 3.0))
        await asyncio.sleep(1.5)
        ann.awake.clear()
        for _ in range(5):
            ann.say("ping", t=1)
        ann.say("stop")
        await asyncio.sleep(0.3)
        assert the.speed == 0.0
        await driving


async def test_a_page_that_takes_nothing_for_ten_seconds_is_sent_away_and_told_why() -> None:
    async with product() as the, Slow(the) as ann:
        ann.say("take_control")
        await asyncio.sleep(0.5)
        ann.awake.clear()
        await asyncio.sleep(PATIENCE - 0.5)
        assert ann.hung_up == []
        await asyncio.sleep(1.0)
        assert ann.hung_up == [(1013, "it took nothing for 10 s")]
        assert the.page.clients.connected == {}
        assert the.control.holder is None


async def test_answers_that_nobody_takes_are_not_piled_up() -> None:
    async with product() as the, Browser(the.app) as ann:
        number = ann.latest("people")["id"]
        queue = SendQueue(the.page, the.page.audiences.first, number)
        for count in range(10 * MOST_ANSWERS):
            queue.answer(Pong(count))
        texts = list(await queue.news())
        assert sum('"pong"' in text for text in texts) == MOST_ANSWERS
        assert f'"t":{10 * MOST_ANSWERS - 1}' in texts[-1]


async def test_the_first_snapshot_after_a_pause_goes_out_at_once_and_then_they_are_paced() -> None:
    loop, flushed = asyncio.get_running_loop(), list[float]()
    snapshots = FrameChannel(lambda: flushed.append(loop.time()))
    await asyncio.sleep(1.0)
    began = loop.time()
    for number in range(100):
        snapshots.put(number % 7, str(number))
        await asyncio.sleep(0.01)
    assert abs(flushed[0] - began - GATHER) < 1e-9
    gaps = [later - earlier for earlier, later in pairwise(flushed)]
    assert min(gaps) > PERIOD - 1e-9
    assert max(gaps) < PERIOD + 0.011


async def test_all_who_are_equally_late_share_one_frame() -> None:
    snapshots = FrameChannel(lambda: None)
    snapshots.put(1, "a1")
    await asyncio.sleep(1.0)
    snapshots.put(2, "b1")
    await asyncio.sleep(1.0)
    snapshots.put(1, "a2")
    await asyncio.sleep(1.0)
    (late,), (prompt,) = snapshots.since(0), snapshots.since(2)
    assert late == '{"type":"robots","snapshots":[a2,b1]}'
    assert prompt == '{"type":"robots","snapshots":[a2]}'
    assert snapshots.since(2)[0] is prompt
    assert snapshots.since(3) == []
