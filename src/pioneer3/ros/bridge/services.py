"""The services of the robot on the side that its node is not on."""

import asyncio
from collections.abc import Callable
from concurrent.futures import TimeoutError as NoAnswerError
from functools import partial
from struct import pack, unpack_from
from typing import Any, Final

from pioneer3.ros.bridge.conversion import Converter
from pioneer3.ros.bridge.relay import Inbox
from pioneer3.ros.bridge.rows import ServiceRow, Side
from pioneer3.ros.node.services import EMPTY, SET_BOOL
from pioneer3.ros.ros2.backend import Backend, Closable, Qos, Writer
from pioneer3.ros.tcpros.node import Ros1Node
from pioneer3.ros.tcpros.services import ServiceError

SERVED: Final = 3.0
"""A service that does not respond within this time [s] is not there."""
MATCHED: Final = 1.0
"""Longest wait for a subscriber to the topic of a service [s]."""
LOOK: Final = 0.02


class ServiceBridge:
    """Passes on calls; `tell` is given a sentence when one without a response fails."""

    def __init__(
        self, node: Ros1Node, backend: Backend, converter: Converter, tell: Callable[[str], None]
    ) -> None:
        self._node, self._backend, self._tell = node, backend, tell
        self._ros1, self._types = converter.ros1, converter.ros2
        self._loop = asyncio.get_running_loop()
        self._running: set[asyncio.Task[None]] = set()

    def offer(self, row: ServiceRow, robot: Side) -> Closable | None:
        """Offer a service of the robot on the other side; in a thread."""
        if robot is Side.ROS2:
            return self._offer_in_ros1(row)
        return self._offer_in_ros2(row)

    def _offer_in_ros1(self, row: ServiceRow) -> Closable | None:
        writer: Writer | None = None
        if not self._backend.serves:
            type_ = self._types.message_type(row.topic_type)
            writer = self._backend.advertise(row.ros2, type_, Qos())

        async def handle(request: bytes) -> bytes:
            on = bool(request[:1] == b"\x01")
            success, words = await self._call_ros2(row, writer, on=on)
            if row.ros1_type == EMPTY:
                if not success:
                    raise ServiceError(words)
                return b""
            return pack("<?I", success, len(words.encode())) + words.encode()

        type_name = self._ros1.service_definition(row.ros1_type)
        self._loop.call_soon_threadsafe(self._node.serve, row.ros1, type_name, handle)
        return writer

    async def _call_ros2(
        self, row: ServiceRow, writer: Writer | None, *, on: bool
    ) -> tuple[bool, str]:
        """Call the service, or publish on its topic; return whether it worked, and its words."""
        if writer is None:
            type_ = self._types.service_type(row.ros2_type)
            request = self._request(type_.request.name, row, on=on)
            try:
                cdr = await asyncio.to_thread(self._backend.call, row.ros2, type_, request, SERVED)
            except TimeoutError as error:
                return False, f"nobody serves {row.ros2} in ROS 2: {error}"
            response = self._types.decode(cdr, type_.response.name)
            return bool(response.success), str(response.message)
        until = self._loop.time() + MATCHED
        while not writer.matched and self._loop.time() < until:  # noqa: ASYNC110
            await asyncio.sleep(LOOK)
        if not writer.matched:
            return False, f"nobody takes {row.ros2} in ROS 2"
        writer.write(self._request(row.topic_type, row, on=on))
        return True, "sent; over this network nobody responds"

    def _request(self, type_name: str, row: ServiceRow, *, on: bool) -> bytes:
        message = self._types.make(type_name)
        if row.ros1_type == SET_BOOL:
            message.data = on
        return self._types.encode(message)

    def _offer_in_ros2(self, row: ServiceRow) -> Closable:
        if not self._backend.serves:
            inbox = Inbox(partial(self._act, row), self._loop)
            type_ = self._types.message_type(row.topic_type)
            return self._backend.subscribe(
                row.ros2, type_, Qos(), lambda cdr, gid: inbox.put(cdr), lambda gid: None
            )
        service = self._types.service_type(row.ros2_type)

        def respond(cdr: bytes) -> bytes:
            response = self._types.make(service.response.name)
            response.success, response.message = self._call_and_wait(
                row, self._types.decode(cdr, service.request.name)
            )
            return self._types.encode(response)

        return self._backend.serve(row.ros2, service, respond)

    def _call_and_wait(self, row: ServiceRow, request: Any) -> tuple[bool, str]:
        """Call the service in ROS 1; in a thread."""
        try:
            call = asyncio.run_coroutine_threadsafe(self._call_ros1(row, request), self._loop)
            return call.result(SERVED + MATCHED)
        except (RuntimeError, NoAnswerError, asyncio.CancelledError):
            return False, "the bridge is ending"

    def _act(self, row: ServiceRow, cdr: bytes) -> None:
        """Call the service in ROS 1, as a message on its topic asks."""

        async def act() -> None:
            request = self._types.decode(cdr, row.topic_type)
            success, words = await self._call_ros1(row, request)
            if not success:
                self._tell(f"{row.ros1} has FAILED: {words}")

        task = asyncio.create_task(act())
        self._running.add(task)
        task.add_done_callback(self._running.discard)

    async def _call_ros1(self, row: ServiceRow, request: Any) -> tuple[bool, str]:
        data = pack("<?", bool(request.data)) if row.ros1_type == SET_BOOL else b""
        try:
            response = await self._node.call(
                row.ros1, self._ros1.service_definition(row.ros1_type), data
            )
        except ServiceError as error:
            return False, str(error)
        if row.ros1_type == EMPTY:
            return True, ""
        success, size = unpack_from("<?I", response)
        return success, response[5 : 5 + size].decode(errors="replace")
