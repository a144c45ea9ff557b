"""The simulator on the network: each robot has a TCP port, and one loop advances the time.

A tick is: bytes in, answers out, a step of the world, the reports of the robots that are due. While
nobody notices, the loop sleeps until a report is due or a host sends bytes, and then makes up for
the ticks that it has slept over, before it takes these bytes.
Robots know the world's time, never the machine's, and take bytes only between steps, so the same
bytes at the same ticks give the same simulation to the last bit, with any :class:`Pacer`. Only
SIMSTAT tells real time.

Bytes of lasers on serial lines leave between ticks too, while time passes steadily: programs give
up a telegram that pauses for longer than a real one does.
"""

import asyncio
import logging
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from math import ceil, inf
from typing import TYPE_CHECKING

from pioneer3.clock import Clock
from pioneer3.errors import LinkError
from pioneer3.sim.firmware import CYCLE, Firmware
from pioneer3.sim.firmware.console import StepTimes
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.laser_ports import LaserPorts
from pioneer3.sim.server.listeners import PtyListener, TcpListener, listening
from pioneer3.sim.server.pacer import LATELY, PATIENCE, TICK, Pacer
from pioneer3.sim.server.port import RobotPort
from pioneer3.sim.world import World

if TYPE_CHECKING:
    from pioneer3.sim.server.camera_ports import CameraPorts

log = logging.getLogger(__name__)

LONGEST_TURN = 0.02
"""Hosts are read at least this often, however slowly time passes [s, real]."""
PIECES_APART = 0.004
"""Bytes of serial lines leave in pieces, so far apart at least [s, real]."""
MADE_UP = 0.002
"""Steps in which robots move are put off only if they take no longer together [s, real]."""
TICKS_PER_CYCLE = round(CYCLE / TICK)
SLACK = 1e-6
"""Times are sums of ticks, and rounded [s]."""


class Simulation:
    """A world with its robots' ports, in time.

    With `keep_session` a host that vanishes from the network leaves its session behind, as on a
    serial line. With `threads` a step that takes long is done by another thread, while the event
    loop serves others; not where the loop's time is virtual, which would not wait.

    Attributes:
        pace: The speed of time, which may be changed while the simulation runs.
        cameras: Their cameras with pictures; `None` without physics or OpenGL.
        watched: Somebody looks at the world between reports, so that no step is put off in which
            robots move.
    """

    def __init__(
        self,
        world: World,
        firmwares: Sequence[Firmware],
        *,
        pace: Pacer | None = None,
        keep_session: bool = False,
        threads: bool = False,
    ) -> None:
        self.world = world
        self._threads = threads
        self.pace = pace or Pacer()
        self.ports: list[RobotPort] = []
        self._keep_session = keep_session
        self._heard = asyncio.Event()
        self.lasers = LaserPorts(world, self._heard.set)
        self.cameras: CameraPorts | None = None
        self._host: str | None = None
        self._next_number = 0
        self._ticks = self._turns = 0
        self._watchdog_factor = 1.0
        self._reported_at = -inf
        self._waiting_since: float | None = None
        self.watched = False
        self._idle, self._effort, self._last_effort = 0, 0.0, 0.0
        for firmware in firmwares:
            self.attach(firmware)

    @property
    def addresses(self) -> list[tuple[str, int]]:
        """Host and number of each TCP port, in the order of :attr:`ports`."""
        return [port.address for port in self.ports if port.address]

    async def listen(
        self,
        first_port: int,
        host: str = "127.0.0.1",
        *,
        ports: Sequence[int | None] = (),
        hosts: Sequence[str] = (),
    ) -> None:
        """Open a TCP port per robot at `host`, on consecutive numbers; 0 takes free ones.

        `ports` has a robot's own number, or `None` for the next, and `hosts` its own address of
        this machine, or empty for `host`; both may be shorter than the robots.

        Raises:
            PortBusyError: Another program listens there.
            LinkError: This machine has no such address, or the port is not allowed.
        """
        self._host, self._next_number = host, first_port
        own = [*ports, *[None] * len(self.ports)]
        at = [*hosts, *[""] * len(self.ports)]
        try:
            for port, number, place in zip(self.ports, own, at, strict=False):
                await self._open(port, number, taken=own, host=place)
        except LinkError:
            self.close()
            raise

    def open_ptys(self) -> list[str]:
        """Make a pseudo terminal for each robot, as a serial port besides TCP; return their names.

        Raises:
            LinkError: This machine has no more of them.
        """
        paths = []
        try:
            for port in self.ports:
                listener = PtyListener(port)
                port.listeners.append(listener)
                paths.append(listener.path)
        except LinkError:
            self.close()
            raise
        return paths

    def attach(self, firmware: Firmware) -> RobotPort:
        """Add a robot; return its port, which can :meth:`RobotPort.serve` hosts."""
        port = RobotPort(firmware, self._heard.set, keep_session=self._keep_session)
        port.scale_watchdog(self._watchdog_factor)
        self.ports.append(port)
        return port

    async def add(self, firmware: Firmware, port: int | None = None) -> int:
        """Let hosts connect to one more robot; return its TCP port, the next one if not given.

        Raises:
            PortBusyError: Another program listens there.
            LinkError: The port is not allowed, or :meth:`listen` has not been called.
        """
        added = self.attach(firmware)
        try:
            return await self._open(added, port)
        except LinkError:
            self.ports.remove(added)
            raise

    async def add_laser(
        self, firmware: Firmware, name: str, port: int | None = None
    ) -> SimulatedLaser:
        """Fit a laser to a robot, and let hosts connect to it; see :meth:`LaserPorts.add`.

        Without `port` it has a free port where the robots have such. From the next session on
        the robot tells its own name (:meth:`Firmware.use_own_name`).

        Raises:
            ConfigError: There is no such laser.
            LinkError: It cannot listen, or :meth:`listen` has not been called.
        """
        if self._host is None:
            raise LinkError("a laser can be given a port only while the robots listen")
        free = not self._next_number
        laser = await self.lasers.add(firmware.body, name, port, self._host, free=free)
        firmware.use_own_name()
        return laser

    async def remove(self, firmware: Firmware) -> None:
        """Disconnect a robot's host and close its port; the robot's session ends.

        Raises:
            ValueError: It has no port here.
        """
        port = next((port for port in self.ports if port.firmware is firmware), None)
        if port is None:
            raise ValueError(f"{firmware.identity.name}: this robot has no port here")
        self.ports.remove(port)
        port.close()
        firmware.hang_up(self.world.time)

    async def run(self) -> None:
        """Advance the time until cancelled; then close every port."""
        clock = asyncio.get_running_loop().time
        try:
            while True:
                rest = await self._turn(clock)
                if self._waiting_since is not None or self._idle:
                    await self._sleep_until_heard(rest)
                else:
                    await asyncio.sleep(rest)
        finally:
            self.close()

    async def _turn(self, clock: Clock) -> float:
        """Take bytes of hosts, and step if a tick is due; return how long to sleep [s, real]."""
        now = clock()
        self._report_pace(now)
        heard, slept = self._hosts_heard(), self._idle
        while slept and self._hosts_heard() == heard and self.pace.is_late(now):
            await self._tick()
            self.pace.passed(now)
            slept -= 1
        self._receive(self.world.time + self.pace.elapsed(now))
        wait = self.pace.wait(now)
        if wait == 0 and self._all_have_answered(now):
            await self._tick()
            self.pace.passed(now)
            now = clock()
            wait = self.pace.wait(now)
        else:
            wait = wait or LONGEST_TURN
            if self.pace.paused:
                self._turns += 1
                self._waiting_since = None
        self._idle = self._idle_ticks()
        if self._idle:
            return wait + self._idle * TICK / self.pace.speed
        return min(LONGEST_TURN, wait, self._until_bytes_leave(now))

    def _idle_ticks(self) -> int:
        """Return in how many of the next ticks nothing happens that anybody could notice."""
        if self.cameras is not None or not self.pace.steady:
            return 0
        if not all(laser.quiet for laser in self.lasers.lasers):
            return 0
        if self._hosts_heard() or (self.watched and not self.world.is_still):
            return 0
        due = min((port.due for port in self.ports), default=inf)
        ticks = min((due - self.world.time - SLACK) / TICK, TICKS_PER_CYCLE)
        if ticks * self._effort > MADE_UP and not self.world.is_still:
            ticks = MADE_UP / self._effort
        return ceil(ticks) - 1 if ticks > 0 else 0

    def _hosts_heard(self) -> int:
        """Return of how many hosts bytes wait for their robots."""
        return sum(port.pending for port in self.ports)

    def _until_bytes_leave(self, now: float) -> float:
        """Return how long after `now` another piece leaves a serial line [s, real]."""
        due = self.lasers.due
        if due == inf or not self.pace.steady:
            return inf
        wait = (due - self.world.time - self.pace.elapsed(now)) / self.pace.speed
        return max(PIECES_APART, wait)

    def _report_pace(self, now: float) -> None:
        """Tell the robots how fast time passes."""
        if self._watchdog_factor != self.pace.watchdog_factor:
            self._watchdog_factor = self.pace.watchdog_factor
            for port in self.ports:
                port.scale_watchdog(self._watchdog_factor)
        if now - self._reported_at < LATELY or not self.pace.real_time_factor:
            return
        self._reported_at = now
        wanted, measured = CYCLE / self.pace.speed, CYCLE / self.pace.real_time_factor
        times = StepTimes(simulated=CYCLE, wanted=wanted, measured=measured)
        for port in self.ports:
            port.firmware.console.step_times = times

    def _receive(self, between_ticks: float) -> None:
        """Give all robots and lasers the bytes of their hosts, and send their answers.

        `between_ticks` is the time of lasers, whose clocks go on [s, simulated].
        """
        now, in_cycle = self.world.time, self._ticks % TICKS_PER_CYCLE
        hold = self.pace.lock_step and in_cycle > 0
        spread = self.pace.speed >= 1 and not self.pace.paused  # else it may last
        openings: int | None = None
        for port in self.ports:
            port.check_cable()
            if not port.pending:
                continue
            if port.opens_next and spread:
                openings = self._openings_left(in_cycle) if openings is None else openings
                if openings <= 0:
                    continue
            was_open = port.is_open
            with self._isolated(port):
                port.take(now, self._turns, listen=not (hold and was_open))
                port.flush(now)
            if port.is_open and not was_open:
                port.report_tick = in_cycle
                openings = openings and openings - 1
        self.lasers.exchange(between_ticks)

    def _openings_left(self, slot: int) -> int:
        """Return how many sessions may still open in this tick of the cycle.

        A session's reports come in the tick of the cycle that it was opened in. Were they all in
        the same one, that would be late and the others idle.
        """
        open_in = Counter(port.report_tick for port in self.ports if port.is_open)
        return ceil(len(self.ports) / TICKS_PER_CYCLE) - open_in[slot]

    async def _tick(self) -> None:
        clock = asyncio.get_running_loop().time
        began = clock()
        work = self.world.start(TICK) if self._threads else None
        if work is None:
            self.world.step(TICK)
        else:
            await asyncio.shield(asyncio.wrap_future(work))
            self.world.finish(TICK)
        took = clock() - began
        # one step that another program held up says little
        self._effort, self._last_effort = min(took, self._last_effort), took
        self._ticks += 1
        self._turns += 1
        now = self.world.time
        due = [port for port in self.ports if port.due <= now + SLACK]
        self.world.expect(port.firmware.body for port in due)
        for port in due:
            with self._isolated(port):
                port.tick(now)
        self.lasers.tick(now)
        if self.cameras is not None:
            self.cameras.tick(now)

    @contextmanager
    def _isolated(self, port: RobotPort) -> Iterator[None]:
        """Keep an error of one robot from the others."""
        try:
            yield
        except Exception:
            log.exception("%s: the simulated robot failed, its host is cut off", port.label)
            port.fail()

    def _all_have_answered(self, now: float) -> bool:
        """Whether time may pass; in lock step it waits for the hosts at the end of each cycle."""
        if not self.pace.lock_step or self._ticks % TICKS_PER_CYCLE:
            self._waiting_since = None
            return True
        if any(port.awaited for port in self.ports):
            if self._waiting_since is None:
                self._waiting_since = now
            if now - self._waiting_since < PATIENCE:
                self.pace.postpone(now)
                return False
        self._waiting_since = None
        for port in self.ports:
            port.expect_packet()
        return True

    async def _sleep_until_heard(self, seconds: float) -> None:
        self._heard.clear()
        with suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self._heard.wait()

    async def _open(
        self,
        port: RobotPort,
        number: int | None,
        taken: Sequence[int | None] = (),
        host: str = "",
    ) -> int:
        if self._host is None:
            raise LinkError("a robot can be given a port only while the others listen")
        if number is None:
            number = self._next_number
            while number and (number in taken or any(number == used for _, used in self.addresses)):
                number += 1
            self._next_number = number + 1 if number else 0
        listener = await listening(host or self._host, number)
        address = listener.getsockname()
        port.address = address[0], address[1]
        port.listeners.append(TcpListener(port, listener))
        return port.address[1]

    def close(self) -> None:
        """Close every port; :meth:`run` does so in the end."""
        for port in self.ports:
            port.close()
        self.lasers.close()
