"""Requests to a robot's node besides velocities: its services, or the topics in their place."""

import logging
import time
from collections import deque
from threading import Condition, Lock, Thread
from typing import Final

from pioneer3.ros.node.middleware import Publisher
from pioneer3.ros.ros2.backend import Backend, EndpointKind
from pioneer3.ros.ros2.middleware import Ros2Topics
from pioneer3.ros.ros2.types import MessageTypes

ENABLE: Final = "enable_motors"
DISABLE: Final = "disable_motors"
TRIGGER: Final = "e_stop_trigger"
RESET: Final = "e_stop_reset"
EMPTY: Final = "std_msgs/Empty"
SERVED: Final = 2.0
"""A service or topic that nobody serves within this time [s] is not there."""
APPEARS: Final = 0.5
"""A node's emergency stop is found within this time [s] after its velocity topic."""
LEAVING: Final = SERVED + 1.0
"""Longest wait for requests at the end [s]."""
LOOK: Final = 0.02
"""Pause between two looks for a subscriber or a service [s]."""
MOST: Final = 8
"""Requests that wait; the newest stay."""
log = logging.getLogger(__name__)


class NodeRequests:
    """Makes requests in threads of its own: a node out of reach delays no other one.

    Requests keep their order, but for the emergency stop: it waits for none and drops those that
    wait. One that is on its way cannot undo it, as it is then made again. `node` is the full name
    of the robot's node.
    """

    def __init__(
        self, backend: Backend, types: MessageTypes, middleware: Ros2Topics, node: str
    ) -> None:
        self._backend, self._types, self._middleware = backend, types, middleware
        self._node = node
        self._publishers: dict[str, Publisher] = {}
        self._waiting: deque[str] = deque(maxlen=MOST)
        self._is_busy = False
        self._triggers = 0
        self._changed, self._advertising = Condition(), Lock()
        self._opened_at = time.monotonic()
        self._open = True
        self._threads = [
            Thread(target=run, name=f"requests to {node}", daemon=True)
            for run in (self._run, self._run_triggers)
        ]

    def open(self) -> None:
        """Begin; nothing is waited for."""
        self._opened_at = time.monotonic()
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """Finish the requests that wait, within :data:`LEAVING`, and take no more; in a thread."""
        with self._changed:
            self._open = False
            self._changed.notify_all()
        end = time.monotonic() + LEAVING
        for thread in self._threads:
            if thread.is_alive():
                thread.join(max(0.0, end - time.monotonic()))

    def switch_motors(self, on: bool) -> None:
        """Ask for power on the motors, or none."""
        self._ask(ENABLE if on else DISABLE)

    def latch(self, on: bool) -> None:
        """Ask for the emergency stop, or its release; a node without one takes the power away."""
        if not on:
            self._ask(RESET)
            return
        with self._changed:
            self._waiting.clear()
            self._triggers = min(self._triggers + 1, 2)  # one may be on its way, and fail
            self._changed.notify_all()

    def _ask(self, name: str) -> None:
        with self._changed:
            if not self._waiting or self._waiting[-1] != name:
                self._waiting.append(name)
                self._changed.notify_all()

    def _run(self) -> None:
        """Make the requests that wait, each after the emergency stops that were asked for first."""
        for name in (ENABLE, DISABLE, TRIGGER, RESET):
            try:
                if self._kind(name) is EndpointKind.SUBSCRIBER:
                    self._publisher(name)  # then the first request does not wait
            except Exception:
                log.exception("%s: cannot publish on %s", self._node, name)
        while True:
            with self._changed:
                self._is_busy = False
                self._changed.notify_all()
                self._changed.wait_for(
                    lambda: not self._triggers and (self._waiting or not self._open)
                )
                if not self._waiting:
                    return
                name, self._is_busy = self._waiting.popleft(), True
            self._try(name)

    def _run_triggers(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._triggers or not self._open)
                if not self._triggers:
                    return
                is_overtaken = self._is_busy
            self._try(TRIGGER)
            if is_overtaken:
                with self._changed:
                    self._changed.wait_for(lambda: not self._is_busy)
                self._try(TRIGGER)
            with self._changed:
                self._triggers -= 1
                self._changed.notify_all()

    def _appears(self, name: str) -> bool:
        """Return whether the node has this; while it may just have been discovered, wait for it."""
        while self._kind(name) is None:
            if time.monotonic() > self._opened_at + APPEARS:
                return False
            time.sleep(LOOK)
        return True

    def _try(self, name: str) -> None:
        try:
            if name == TRIGGER and not self._appears(TRIGGER):
                name = DISABLE
            self._request(name)
        except TimeoutError:
            log.warning("%s has not taken %s within %g s", self._node, name, SERVED)
        except Exception:
            log.exception("%s: %s failed", self._node, name)

    def _kind(self, name: str) -> EndpointKind | None:
        """Return whether the node serves this, or subscribes to it; `None` for neither."""
        full, kinds = self._full(name), {EndpointKind.SUBSCRIBER}
        if self._backend.serves:
            kinds.add(EndpointKind.SERVER)
        found = (each for each in self._backend.graph().endpoints if each.name == full)
        return next((e.kind for e in found if e.node == self._node and e.kind in kinds), None)

    def _request(self, name: str) -> None:
        """Make a request, or log that there is none such; TimeoutError if nobody takes it."""
        kind = self._kind(name)
        if kind is None:
            log.warning("%s has no %s, neither a service nor a topic", self._node, name)
        elif kind is EndpointKind.SERVER:
            trigger = self._types.service_type("std_srvs/Trigger")
            request = self._types.encode(self._types.make(trigger.request.name))
            self._backend.call(self._full(name), trigger, request, SERVED)
        else:
            publisher, end = self._publisher(name), time.monotonic() + SERVED
            while not publisher.subscribed:
                if time.monotonic() > end or (self._triggers and name in {ENABLE, RESET}):
                    raise TimeoutError
                time.sleep(LOOK)
            publisher.publish(self._middleware.make(EMPTY))

    def _publisher(self, name: str) -> Publisher:
        with self._advertising:
            if name not in self._publishers:
                self._publishers[name] = self._middleware.advertise(self._full(name), EMPTY)
            return self._publishers[name]

    def _full(self, name: str) -> str:
        return f"{self._node.rpartition('/')[0]}/{name}"
