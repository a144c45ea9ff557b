"""A phone that publishes how it turns, as keys."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import suppress
from typing import Any, Final

from pioneer3.ros.ros1.messages import message_class
from pioneer3.teleop.flick import key_of
from pioneer3.teleop.keyboard import Key

IMU: Final = "sensor_msgs/Imu"
SILENT: Final = 0.5
"""A phone that says nothing for this long [s] has gone: the robot stops."""
QUEUE: Final = 100
"""A flick is a few messages long; none of them may be dropped."""


async def flicks(topic: str) -> AsyncIterator[Key]:
    """Yield a key for each message of a phone that is flicked, a stop when it falls silent."""
    import rospy  # noqa: PLC0415

    loop, keys = asyncio.get_running_loop(), asyncio.Queue[Key | None]()

    def received(message: Any) -> None:
        turns = message.angular_velocity
        with suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(keys.put_nowait, key_of(turns.x, turns.y, turns.z))

    def subscribe() -> Any:
        return rospy.Subscriber(topic, message_class(IMU), received, queue_size=QUEUE)

    subscriber = await asyncio.to_thread(subscribe)
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
        subscriber.unregister()
