"""Many readers of one value: none waits for another."""

import asyncio

from pioneer3.robot.supervisor import Feed


async def collect(feed: Feed[int], pause: float = 0.0) -> list[int]:
    got = []
    async for value in feed.values():
        got.append(value)
        await asyncio.sleep(pause)
    return got


async def test_a_reader_gets_what_is_published_from_then_on() -> None:
    feed: Feed[int] = Feed()
    feed.publish(1)
    reader = asyncio.ensure_future(collect(feed))
    await asyncio.sleep(0.1)
    for value in (2, 3):
        feed.publish(value)
        await asyncio.sleep(0.1)
    feed.close()
    assert await reader == [2, 3]
    assert feed.latest == 3


async def test_a_slow_reader_misses_old_values_and_blocks_nobody() -> None:
    feed: Feed[int] = Feed()
    fast, slow = asyncio.ensure_future(collect(feed)), asyncio.ensure_future(collect(feed, 0.25))
    await asyncio.sleep(0.1)
    for value in range(10):
        feed.publish(value)
        await asyncio.sleep(0.1)
    feed.close()
    assert await fast == list(range(10))
    got = await slow
    assert got[0] == 0
    assert len(got) == 5
    assert got[-1] == 9
    assert got == sorted(got)


async def test_closing_ends_readers_that_wait_and_those_that_come_later() -> None:
    feed: Feed[int] = Feed()
    waiting = asyncio.ensure_future(collect(feed))
    await asyncio.sleep(0)
    feed.close()
    assert await waiting == []
    assert await collect(feed) == []


async def test_the_last_value_is_read_though_the_feed_is_closed_at_once() -> None:
    feed: Feed[int] = Feed()
    reader = asyncio.ensure_future(collect(feed))
    await asyncio.sleep(0)
    feed.publish(1)
    feed.publish(2)
    feed.close()
    assert await reader == [2]
