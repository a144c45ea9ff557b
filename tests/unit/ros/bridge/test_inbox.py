"""The way of messages into the loop."""

import asyncio

from pioneer3.ros.bridge.relay import Inbox


async def test_a_message_that_fails_does_not_take_others_with_it() -> None:
    taken: list[int] = []

    def take(number: int) -> None:
        taken.append(10 // number)

    inbox = Inbox(take, asyncio.get_running_loop())
    for number in (5, 0, 2):
        inbox.put(number)
    await asyncio.sleep(0.05)
    assert taken == [2, 5]
