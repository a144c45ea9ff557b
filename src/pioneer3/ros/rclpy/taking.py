"""Takes messages from rclpy as `rclpy.wait_for_message` does, without an executor.

For each message, rclpy's executors arrange all entities of a node anew, in Python: some 5 ms for
the sixty of a robot's node. One thread that waits for subscriptions alone needs a tenth of it.
"""

import logging
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from threading import Event, Lock, Thread
from typing import Any

log = logging.getLogger(__name__)
Taken = Callable[[bytes, Mapping[str, Any]], None]
"""Given a serialized message and what rclpy tells about it."""


def apart() -> Any:
    """Return a group of entities that executors leave alone."""
    from rclpy.callback_groups import ReentrantCallbackGroup

    group = ReentrantCallbackGroup()
    group.can_execute = lambda entity: False
    return group


class Taking:
    """Takes the messages of subscriptions in one thread; those of one come in their order."""

    def __init__(self, context: Any) -> None:
        from rclpy.guard_condition import GuardCondition

        self._context = context
        self._changed = GuardCondition(None, None, context=context)
        self._takers: dict[Any, Taken] = {}
        self._lock, self._closed = Lock(), Event()
        self._thread = Thread(target=self._run, name="rclpy taking", daemon=True)
        self._thread.start()

    def add(self, subscription: Any, taken: Taken) -> None:
        """Take its messages from now on."""
        with self._lock:
            self._takers[subscription] = taken
            self._wake()

    def remove(self, subscription: Any) -> None:
        """Take no more of its messages, before it is destroyed."""
        with self._lock:
            self._takers.pop(subscription, None)
            self._wake()

    def close(self, patience: float) -> None:
        """End; wait for that up to `patience` [s]."""
        with self._lock:
            self._wake()
            self._closed.set()
        self._thread.join(patience)
        self._changed.destroy()

    def _wake(self) -> None:
        if not self._closed.is_set():
            self._changed.trigger()

    def _run(self) -> None:
        from rclpy.impl.implementation_singleton import rclpy_implementation as rcl

        try:
            while not self._closed.is_set():
                self._take_once(rcl)
        except rcl.RCLError:
            if not self._closed.is_set():  # somebody has ended the context
                log.exception("no more messages are taken from rclpy")

    def _take_once(self, rcl: Any) -> None:
        """Wait for messages or a change, and take what is there."""
        with self._lock:
            takers = dict(self._takers)
        with ExitStack() as used:  # what is destroyed meanwhile stays until the wait is over
            for subscription in tuple(takers):
                try:
                    used.enter_context(subscription.handle)
                except rcl.InvalidHandle:
                    del takers[subscription]
            wait_set = rcl.WaitSet(len(takers), 1, 0, 0, 0, 0, self._context.handle)
            used.enter_context(wait_set)
            wait_set.clear_entities()
            for subscription in takers:
                wait_set.add_subscription(subscription.handle)
            wait_set.add_guard_condition(self._changed.handle)
            wait_set.wait(-1)  # for ever
            ready = set(wait_set.get_ready_entities("subscription"))
            for subscription, taken in takers.items():
                if subscription.handle.pointer in ready:
                    _take_all(subscription, taken)


def _take_all(subscription: Any, taken: Taken) -> None:
    while (found := subscription.handle.take_message(subscription.msg_type, True)) is not None:
        taken(*found)
