"""A phone that publishes its rates of turning, as keys of a keyboard."""

import asyncio
from collections.abc import AsyncIterator
from typing import Any, Final

from pioneer3.ros.node.middleware import Sender, Topics
from pioneer3.tasks import hand_over
from pioneer3.teleop.keyboard import Key, key_of_rotation

IMU: Final = "sensor_msgs/Imu"
SILENT: Final = 0.5
"""A phone that publishes nothing for this long [s] has gone: the robot stops."""
QUEUE: Final = 100
"""A flick is a few messages long; none of them may be dropped."""


async def flicks(topic: str, middleware: Topics) -> AsyncIterator[Key]:
    """Yield a key for each message of a phone that is flicked, a stop when it falls silent."""
    loop, keys = asyncio.get_running_loop(), asyncio.Queue[Key | None]()

    def receive(message: Any, _: Sender) -> None:
        turns = message.angular_velocity
        hand_over(loop, keys.put_nowait, key_of_rotation(turns.x, turns.y, turns.z))

    unsubscribe = await asyncio.to_thread(middleware.subscribe, topic, IMU, receive, queue=QUEUE)
    drives = False
    try:
        while True:
            try:
                async with asyncio.timeout(SILENT if drives else None):
                    key = await keys.get()
            except TimeoutError:
                key = Key.STOP
            if key is not None:
                drives = key is not Key.STOP
                yield key
    finally:
        unsubscribe()
