"""The state of a robot from a few of its topics, for those who only look."""

import asyncio
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final

from pioneer3.ros.client.graph import ODOMETRY, RobotTopics
from pioneer3.ros.client.snapshots import OF_CLOCK, seconds_of
from pioneer3.ros.node.middleware import Sender, Topics
from pioneer3.tasks import hand_over

BATTERY: Final = "sensor_msgs/BatteryState"
BOOL: Final = "std_msgs/Bool"


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotState:
    """The state of a robot; `None` for all that its topics have not told.

    The battery is in [V]; the emergency stop is latched, or the robot's button pressed. The newest
    odometry has an `age` by its stamp and this computer's clock [s]; since it came where a
    simulator's time is in its stamp. Several `nodes` of its name have told nothing of one robot.
    """

    battery: float | None = None
    motors: bool | None = None
    emergency_stop: bool | None = None
    age: float | None = None
    nodes: int = 1


class StateReader:
    """Subscribes to the topics that tell the state of a robot; the newest messages count."""

    def __init__(self, topics: RobotTopics, middleware: Topics) -> None:
        self._topics, self._middleware = topics, middleware
        self._loop, self._all_told = asyncio.get_running_loop(), asyncio.Event()
        self._silent: set[str] = set()
        self._state = RobotState()
        self._measured_at: float | None = None

    def open(self) -> None:
        """Subscribe, in a thread."""
        topics, motors = self._topics, self._topics.topic(BOOL, "motors_state")
        parts: tuple[tuple[str, str | None, Callable[[RobotState, Any], RobotState]], ...] = (
            (ODOMETRY, topics.pose, self._with_odometry),
            (BATTERY, topics.topic(BATTERY), lambda s, m: replace(s, battery=float(m.voltage))),
            (BOOL, motors, lambda s, m: replace(s, motors=bool(m.data))),
            (BOOL, topics.emergency_stop, lambda s, m: replace(s, emergency_stop=bool(m.data))),
        )
        self._silent = {name for _, name, _ in parts if name}
        for type_name, name, take in parts:
            if name:
                receive = partial(self._receive, name, take)
                self._middleware.subscribe(name, type_name, receive, queue=1)

    async def state(self, patience: float) -> RobotState:
        """Return the state, once every topic has told something or `patience` [s] is over."""
        with suppress(TimeoutError):
            async with asyncio.timeout(patience):
                await self._all_told.wait()
        measured_at = self._measured_at
        age = None if measured_at is None else time.time() - measured_at
        return replace(self._state, age=age)

    def _receive(
        self, name: str, taken: Callable[[RobotState, Any], RobotState], message: Any, _: Sender
    ) -> None:
        def act() -> None:
            self._state = taken(self._state, message)
            self._silent.discard(name)
            if not self._silent:
                self._all_told.set()

        hand_over(self._loop, act)

    def _with_odometry(self, state: RobotState, message: Any) -> RobotState:
        stamp = seconds_of(message.header.stamp)
        self._measured_at = stamp if stamp > OF_CLOCK else time.time()
        return state
