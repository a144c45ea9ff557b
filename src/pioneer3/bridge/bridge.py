"""One robot, opened when the first host connects, and the hosts that share it."""

import asyncio
import errno
import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from math import inf
from pathlib import Path

from pioneer3.arcos.host_events import Timing
from pioneer3.arcos.packet import encode
from pioneer3.bridge.braking import BRAKING
from pioneer3.bridge.client import BridgeClient, HostPort
from pioneer3.bridge.ports import BridgeLink, MemoryPort, SocketPort
from pioneer3.bridge.relay import EXPIRY, MOST_WATCHERS, SILENCE, Relay
from pioneer3.bridge.robot_side import RobotSideState
from pioneer3.errors import LinkError, PioneerError, PortBusyError
from pioneer3.links import Link, Opener
from pioneer3.links.tap import FROM_HOST, FROM_ROBOT, WireRecording
from pioneer3.log.writer import LogWriter, named_log
from pioneer3.tasks import cancelled

log = logging.getLogger(__name__)

LOOK_EVERY = 0.04
"""How often the operating system is asked what the holder's computer has acknowledged [s]."""
LAST_WRITE = 0.5
"""Longest wait for the link to take the last bytes [s]."""
MOST_WAITING = 2048
"""Most that waits for the robot's link [bytes]; then the host waits."""


class Bridge:
    """Hosts share one robot: the first one has it, the others watch and may stop it.

    Rules: :mod:`pioneer3.bridge.relay`. Nothing is connected until :meth:`run` runs, which opens
    the robot's link when a host needs it.

    Args:
        open_link: Opens the robot's link anew for each session.
        expiry: A holder whose computer acknowledges nothing for this long is cut off, and the
            robot stops [s]; 0 for never. It works over TCP, on Linux.
        silence: The robot stops if its holder has sent no packet for this long [s]; 0 for never.
        most_watchers: More hosts are turned away.
        timing: Timeouts of the handshake with the robot.
        say: Called with a sentence for people at each change; the log if not given.

    Attributes:
        failed: The reason that the last try to reach the robot failed; empty if it did not.
    """

    def __init__(
        self,
        open_link: Opener,
        *,
        expiry: float = EXPIRY,
        silence: float = SILENCE,
        most_watchers: int = MOST_WATCHERS,
        timing: Timing | None = None,
        say: Callable[[str], None] | None = None,
    ) -> None:
        self._open_link = open_link
        self._expiry = expiry
        self._say = say or (lambda text: log.info("%s", text))
        self._relay = Relay(
            expiry=expiry,
            silence=silence,
            most_watchers=most_watchers,
            timing=timing,
            say=self._tell,
        )
        self._clock = asyncio.get_running_loop().time
        self._wake = asyncio.Event()
        self._drained = asyncio.Event()
        self._drained.set()
        self._sockets: set[SocketPort] = set()
        self.log: LogWriter | None = None
        self._recording: WireRecording | None = None
        self.failed = ""

    @property
    def holder(self) -> str | None:
        """Name of the host that has the robot, or `None`."""
        holder = self._relay.holder
        return holder.port.name if holder is not None else None

    @property
    def watchers(self) -> tuple[str, ...]:
        """Names of the hosts that watch."""
        return tuple(client.port.name for client in self._relay.watchers)

    @property
    def connected(self) -> bool:
        """Whether the robot serves a session."""
        return self._relay.robot.state is RobotSideState.SERVING

    @property
    def paused(self) -> bool:
        """Whether the robot stands, whatever its holder commands; may be set at any time.

        After a pause the robot moves for the holder's next command, not for an earlier one.
        """
        return self._relay.paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        if paused != self._relay.paused:
            self._relay.pause(self._clock(), on=paused)
            self._wake.set()

    def stop(self, why: str) -> None:
        """Stop the robot, for a reason that is told; its holder may drive it on."""
        self._relay.stop(why, self._clock())
        self._wake.set()

    @property
    def reserved_for(self) -> str:
        """Name of the only host that may have the robot; empty for any. May be set at any time.

        Another host that has the robot is disconnected. At the end of a reservation the hosts that
        watched are, so that they can connect anew.
        """
        return self._relay.reserved_for

    @reserved_for.setter
    def reserved_for(self, name: str) -> None:
        if name != self._relay.reserved_for:
            self._relay.reserve(name, self._clock())
            self._wake.set()

    def disconnect_others(self, name: str) -> None:
        """Disconnect all hosts but `name`; the robot stops if one of them has it."""
        self._relay.disconnect_others(name, self._clock())
        self._wake.set()

    async def run(self) -> None:
        """Serve hosts until cancelled; then the robot stops and all hosts are disconnected."""
        try:
            while True:
                await self._wait_for_host()
                await self._serve_session()
        finally:
            self._relay.end(self._clock())
            for port in list(self._sockets):
                port.abort()
            self.stop_recording()

    def link(self, name: str = "this program", *, gives_way: bool = False) -> Link:
        """Return a new link to the robot for a host within this process, with a name for people.

        The first host has the robot, and later ones watch, so the same program has it at one time
        and watches at another: the link ends when that changes. From one that `gives_way` any other
        host may take the robot; a later link watches while the other has it.
        """
        return BridgeLink(self, MemoryPort(name, gives_way=gives_way), self._drained.wait)

    def opener(self, name: str = "this program", *, gives_way: bool = False) -> Opener:
        """Return a function that opens :meth:`link` again at each call."""

        async def open_link() -> Link:
            return self.link(name, gives_way=gives_way)

        return open_link

    @asynccontextmanager
    async def listening(self, host: str = "127.0.0.1", port: int = 0) -> AsyncIterator[int]:
        """Take hosts over TCP at an address of this computer; yield the number of the port.

        A port of 0 is a free one.

        Raises:
            PortBusyError: another program listens there.
            LinkError: this computer has no such address, or the port is not allowed.
        """
        loop = asyncio.get_running_loop()
        try:
            server = await loop.create_server(lambda: SocketPort(self, self._sockets), host, port)
        except OSError as error:
            where = f"{host}:{port}"
            if error.errno == errno.EADDRINUSE:
                raise PortBusyError(f"{where}: in use; choose another port") from None
            raise LinkError(f"{where}: cannot listen there: {error.strerror or error}") from None
        try:
            yield server.sockets[0].getsockname()[1]
        finally:
            server.close()
            for each in list(self._sockets):
                each.close()

    def start_recording(self, path: Path) -> None:
        """Record the bytes between the holder and the robot to a new file, which replays.

        A session that goes on already begins with the handshake and the settings that its host got.
        Raises ConfigError if the file cannot be written; one that exists is left alone.
        """
        self.stop_recording()
        self.log = named_log(path, self._clock)
        self._recording = WireRecording(self.log)
        relay = self._relay
        if relay.robot.state is RobotSideState.SERVING:
            for payload in filter(None, (b"\0", b"\1", relay.robot.identity, relay.robot.config)):
                self._recording.note(FROM_ROBOT, encode(payload))
            self._recording.note(FROM_ROBOT, relay.robot.unfinished)

    @property
    def recording_failure(self) -> str:
        """The reason why the recording has ended by itself; empty if it has not."""
        return self.log.failure if self.log is not None else ""

    def stop_recording(self) -> None:
        """End the recording, if there is one."""
        if self.log is not None:
            self.log.close("stopped", LAST_WRITE)
        self.log = self._recording = None

    # Connections, as of `ports.Server`

    def join(self, port: HostPort) -> BridgeClient | None:
        """Take a new connection; return `None` if it was turned away."""
        return self._relay.join(port, self._clock())

    def receive(self, client: BridgeClient, data: bytes) -> bool:
        """Take bytes of a host; return whether it may send more at once."""
        self._relay.receive(client, data, self._clock())
        self._wake.set()
        if self._relay.robot.unsent > MOST_WAITING:
            self._drained.clear()
        return self._drained.is_set()

    def leave(self, client: BridgeClient) -> None:
        """Note that a host has gone."""
        self._relay.leave(client, self._clock())
        self._wake.set()

    def _tell(self, text: str) -> None:
        self._say(text)
        if self._recording is not None:
            self._recording.remark(text)

    # The robot's side

    async def _wait_for_host(self) -> None:
        while not self._relay.wanted:
            self._wake.clear()
            with suppress(TimeoutError):
                async with asyncio.timeout_at(_finite(self._relay.deadline)):
                    await self._wake.wait()
            self._relay.tick(self._clock())

    async def _serve_session(self) -> None:
        """Open the robot's link, and serve its hosts until the session ends."""
        try:
            link = await self._open_link()
        except PioneerError as error:
            self._lose(str(error))
            self._relay.link_closed()
            return
        try:
            if self._relay.wanted:
                self.failed = ""
                self._relay.robot.begin(self._clock(), link.speeds, link.round_trip)
                await self._exchange(link)
        except asyncio.CancelledError:
            # else timeouts below would raise it again instead of TimeoutError, as in Python 3.11.2
            if (task := asyncio.current_task()) is not None:
                task.uncancel()
            self._relay.end(self._clock())
            with suppress(TimeoutError):
                async with asyncio.timeout(BRAKING + LAST_WRITE):
                    await self._exchange(link)
            raise
        finally:
            await self._close(link)

    async def _exchange(self, link: Link) -> None:
        """Pass bytes both ways until the session has ended."""
        relay = self._relay
        reading = asyncio.ensure_future(self._read(link))
        try:
            while True:
                self._wake.clear()
                relay.tick(self._clock())
                self._look_at_holder()
                if (speed := relay.robot.speed_wanted()) is not None:
                    await link.set_speed(speed)
                elif data := relay.robot.outgoing():
                    await self._write(link, data)
                elif relay.robot.state is RobotSideState.CLOSED:
                    return
                else:
                    await self._wait()
        except LinkError as error:
            self._lose(str(error))
        finally:
            await cancelled([reading])

    async def _wait(self) -> None:
        """Wait for bytes, for a host, or for the next time at which something is due."""
        due = self._relay.deadline
        if self._relay.moving and self._expiry:
            due = min(due, self._clock() + LOOK_EVERY)
        with suppress(TimeoutError):
            async with asyncio.timeout_at(_finite(due)):
                await self._wake.wait()

    async def _read(self, link: Link) -> None:
        """Pass the robot's bytes to the hosts."""
        try:
            while data := await link.read():
                if self._recording is not None:
                    self._recording.note(FROM_ROBOT, data)
                self._relay.robot_sent(data, self._clock())
                self._wake.set()
            if self._relay.robot.state is not RobotSideState.CLOSED:
                self._lose("it has closed the link")
        except LinkError as error:
            self._lose(str(error))

    async def _write(self, link: Link, data: bytes) -> None:
        if self._recording is not None:
            self._recording.note(FROM_HOST, data)
        await link.write(data)
        if not self._drained.is_set():
            self._resume()

    def _look_at_holder(self) -> None:
        """Tell the relay what the holder's computer has acknowledged."""
        holder = self._relay.holder
        if holder is None or not isinstance(port := holder.port, SocketPort):
            return
        if (waiting := port.unacknowledged) is not None:
            self._relay.unacknowledged(port.sent, waiting, self._clock())

    def _lose(self, why: str) -> None:
        self.failed = why
        self._relay.robot_lost(why)
        self._wake.set()

    async def _close(self, link: Link) -> None:
        """Close the robot's session in every case, then the link."""
        self._relay.robot.finish(self._clock())
        try:
            if data := self._relay.robot.outgoing():
                with suppress(LinkError, TimeoutError):
                    async with asyncio.timeout(LAST_WRITE):
                        await link.write(data)
        finally:
            self._remember_speed(link)
            await link.close()
            self._relay.link_closed()
            self._resume()

    def _resume(self) -> None:
        """Let hosts send again."""
        self._drained.set()
        for port in self._sockets:
            port.resume()

    def _remember_speed(self, link: Link) -> None:
        scheme, _, path = link.url.partition(":")
        if scheme == "serial" and (speed := self._relay.robot.speed) is not None:
            from pioneer3.links.serial import remember_speed

            remember_speed(path, speed)


def _finite(time: float) -> float | None:
    return None if time == inf else time
