"""The rules of a bridge between hosts and one robot. No I/O: bytes and the time in, bytes out.

Rules:

1. The first host that shakes hands has the robot: it is the *holder*. Its whole packets reach the
   robot as they are, unless :mod:`pioneer3.bridge.guard` holds one back; the robot's bytes reach
   it as they are, from the beginning of a packet on. Later hosts *watch*: they get the same bytes.
2. Of a watcher's packets only STOP, ESTOP and CONFIG count. A stop also takes the power from the
   motors, and the holder's motion is held back until it switches them on again. A STOP that
   belongs to the beginning or the end of a session is routine, and does not count:
   :func:`is_routine`.
3. When the holder leaves, breaks off, or *gives way* to another host, the robot is stopped, its
   session is closed, and all hosts of it are disconnected. They may connect again.
4. A holder whose connection acknowledges nothing for `expiry` while there is something to
   acknowledge is cut off; one that has sent no packet for `silence` is silent. In both cases the
   robot is stopped, if it may be moving.
5. A stop of the bridge is repeated until the robot stands, or a fresh command moves it.
"""

from collections.abc import Callable, Sequence
from math import inf
from typing import Final

from pioneer3.arcos.host_events import Timing
from pioneer3.bridge.braking import EMERGENCY_STOP
from pioneer3.bridge.client import BridgeClient, ClientPhase, HostPort
from pioneer3.bridge.guard import STOPS, Guard, HeldBack
from pioneer3.bridge.robot_side import RobotSide, RobotSideState

EXPIRY: Final = 0.5
"""Longest time without an acknowledgement of the holder's computer [s]."""
SILENCE: Final = 1.5
"""Longest silence of the holder [s]: ARIA sends nothing for up to 0.8 s while it drives, and the
robot's own watchdog waits for 2 s (protocol.md 2.4)."""
MOST_WATCHERS: Final = 8
UNDECIDED: Final = 10.0
"""A connection that has not opened a session by then is closed [s]."""
SETTLE: Final = 0.3
"""Commands that come this soon after a holder is heard again may be from before [s]."""
CONFIG_EVERY: Final = 0.25
"""Shortest pause between two requests for CONFIG by watchers [s]."""
OPEN, CLOSE, CONFIG = 1, 2, 18
SONAR: Final = 28
ROUTINE: Final = frozenset({CLOSE, CONFIG, SONAR})
"""One of these follows each STOP at the beginning or the end of a session."""


def is_routine(packets: Sequence[bytes]) -> bool:
    """Return whether a STOP of a watcher belongs to the beginning or the end of its session.

    A driver in doubt stops the robot when a session begins, when its settings are known, and when
    it leaves. It sends the other `packets` of that occasion in the same write, after the STOP: the
    question for the settings, SONAR 1, or SONAR 0 and CLOSE.
    """
    return any(packet[0] in ROUTINE for packet in packets)


class Relay:
    """Hosts on the one side, a robot on the other; the options are those of a `Bridge`.

    The `holder` has the robot, or will have it next. While it is `paused` the robot stands,
    whatever the holder commands; the only host that may have it is the one it is reserved for,
    unless that is empty.
    """

    def __init__(
        self,
        *,
        expiry: float = EXPIRY,
        silence: float = SILENCE,
        most_watchers: int = MOST_WATCHERS,
        timing: Timing | None = None,
        say: Callable[[str], None] = lambda text: None,
    ) -> None:
        self.holder: BridgeClient | None = None
        self.clients: list[BridgeClient] = []
        self.reserved_for = ""
        self.robot = RobotSide(timing)
        self._expiry, self._silence = expiry, silence
        self._most_watchers = most_watchers
        self._say = say
        self._guard = Guard()
        self.paused = False
        self._alive_at = self._config_asked_at = -inf
        self._acknowledged = 0
        self._cut_off_until = inf

    @property
    def watchers(self) -> list[BridgeClient]:
        """The hosts in session that do not have the robot."""
        return [client for client in self.clients if client.is_open and client is not self.holder]

    @property
    def wanted(self) -> bool:
        """Whether a link to the robot is to be opened."""
        return self.robot.state is RobotSideState.AWAY and self.holder is not None

    @property
    def moving(self) -> bool:
        """Whether the holder's last commands may move the robot."""
        return self._guard.moving

    @property
    def deadline(self) -> float:
        """When :meth:`tick` must next be called [s, monotonic]; `inf` for never."""
        due = [client.joined_at + UNDECIDED for client in self._undecided]
        due += [self.robot.deadline, self._cut_off_until]
        if self._silence and self.holder is not None and self._guard.moving:
            due.append(self.holder.heard_at + self._silence)
        return min(due, default=inf)

    @property
    def _undecided(self) -> list[BridgeClient]:
        """The hosts that have opened no session, and do not wait for the robot either."""
        return [c for c in self.clients if c.phase not in {ClientPhase.ASKED, ClientPhase.OPEN}]

    # Hosts

    def join(self, port: HostPort, now: float) -> BridgeClient | None:
        """Take a new connection; return `None` if it was turned away."""
        if len(self.clients) > self._most_watchers:
            self._say(f"{port.name} was turned away: {len(self.clients)} hosts are connected")
            port.close()
            return None
        client = BridgeClient(port, now)
        self.clients.append(client)
        return client

    def receive(self, client: BridgeClient, data: bytes, now: float) -> None:
        """Process bytes that a host has sent."""
        packets = client.reader.feed(data, now)
        for number, payload in enumerate(packets):
            if client not in self.clients:
                return
            client.heard_at = now
            if client is self.holder:
                self._note_alive(now)
            if not client.is_open:
                self._shake_hands(client, payload, now)
            elif client is self.holder:
                self._command(payload, now)
            else:
                self._heed(client, payload, packets[number + 1 :], now)

    def leave(self, client: BridgeClient, now: float) -> None:
        """Note that a host has gone."""
        if client not in self.clients:
            return
        self.clients.remove(client)
        if client is self.holder:
            self._say(f"{client.port.name} has left; the robot stops")
            self._end(now)
        elif client.is_open:
            self._say(f"{client.port.name} watches no more")

    def unacknowledged(self, sent: int, waiting: int, now: float) -> None:
        """Note that of the bytes `sent` to the holder `waiting` are not acknowledged yet."""
        if sent - waiting > self._acknowledged or not waiting:
            self._acknowledged, self._alive_at = sent - waiting, now
        cut_off = bool(waiting) and self._expiry > 0 and now >= self._alive_at + self._expiry
        if not cut_off or self.holder is None or self.robot.state is not RobotSideState.SERVING:
            return
        self._cut_off_until = inf
        if HeldBack.CUT_OFF not in self._guard.holds:
            self._say(f"{self.holder.port.name} is cut off; the robot stops")
            self._stop(now, HeldBack.CUT_OFF)

    def _note_alive(self, now: float) -> None:
        """Note that the holder is heard; what comes soon after it was cut off may be old."""
        self._alive_at = now
        if HeldBack.CUT_OFF in self._guard.holds and self._cut_off_until == inf:
            self._cut_off_until = now + SETTLE

    def _shake_hands(self, client: BridgeClient, payload: bytes, now: float) -> None:
        if payload[0] == 0:
            self._claim(client, now)
        if not client.shake_hands(payload, self.robot.identity):
            return
        if client is self.holder:
            self._guard = Guard()
            self._guard.holds |= {HeldBack.PAUSED} if self.paused else set()
            self._alive_at = now
        else:
            has = self.holder.port.name if self.holder else "nobody"
            self._say(f"{client.port.name} watches; {has} has the robot")
        client.port.send(self.robot.unfinished)

    def _claim(self, client: BridgeClient, now: float) -> None:
        """Give the robot to a host if it is free, or the holder gives way."""
        holder = self.holder
        if client is holder or self.reserved_for not in {"", client.port.name}:
            return
        if holder is None:
            self._hold(client)
        elif holder.port.gives_way and not client.port.gives_way:
            self._say(f"{holder.port.name} gives way to {client.port.name}")
            self._end(now, keep=client)
            self._hold(client)

    def _hold(self, client: BridgeClient) -> None:
        self.holder, self._acknowledged = client, 0
        self._say(f"{client.port.name} has the robot")

    def _command(self, payload: bytes, now: float) -> None:
        """Pass a packet of the holder to the robot."""
        if payload[0] == CLOSE:
            assert self.holder is not None
            self._say(f"{self.holder.port.name} has closed its session")
            self._end(now)
            return
        if payload[0] == OPEN:  # the robot has had its OPEN
            return
        was_moving, held = self._guard.moving, self._guard.withheld
        passed = self._guard.passed(payload, powerless=self.robot.powerless)
        if self._guard.withheld == held and self._guard.moving and not was_moving:
            self.robot.release()
        self.robot.send([passed])

    def _heed(
        self, client: BridgeClient, payload: bytes, later: Sequence[bytes], now: float
    ) -> None:
        """Act on a packet of a watcher."""
        number = payload[0]
        if number == CLOSE:
            client.port.close()
            self.leave(client, now)
        elif self.robot.state is not RobotSideState.SERVING:
            return
        elif number == CONFIG and now >= self._config_asked_at + CONFIG_EVERY:
            self._config_asked_at = now
            self.robot.send([payload])
        elif number in STOPS:
            hard = payload[0] == EMERGENCY_STOP[0]
            if hard or not is_routine(later):
                self._say(f"{client.port.name} stops the robot")
                self._stop(now, HeldBack.STOPPED, take_power=True, hard=hard)

    # Reservation

    def reserve(self, name: str, now: float) -> None:
        """Let nobody but the host `name` have the robot; empty ends that.

        Another host that has it is disconnected. Hosts that watched while the robot was reserved
        are disconnected at the end, so that they can connect anew and have it.
        """
        self.reserved_for = name
        if name:
            self.disconnect_others(name, now, watchers=False)
        elif any(not client.port.gives_way for client in self.watchers):
            self._end(now)

    def disconnect_others(self, name: str, now: float, *, watchers: bool = True) -> None:
        """Disconnect the host that has the robot unless it is `name`, and `watchers` likewise."""
        if self.holder is not None and self.holder.port.name != name:
            self._say(f"{self.holder.port.name} is disconnected")
            self._end(now)
        for client in [c for c in self.clients if watchers and c.port.name != name]:
            client.port.close()
            self.leave(client, now)

    # Stop and pause

    def stop(self, why: str, now: float) -> None:
        """Stop the robot; the holder's next command moves it again."""
        self._say(why)
        self._stop(now)

    def pause(self, now: float, *, on: bool) -> None:
        """Stop the robot and hold back the holder's motion, or let its next command move it."""
        self.paused = on
        if on:
            self._say("paused; the robot stops")
            self._stop(now, HeldBack.PAUSED)
        else:
            self._say("the pause has ended")
            self._guard.holds.discard(HeldBack.PAUSED)

    # The robot

    def robot_sent(self, data: bytes, now: float) -> None:
        """Process bytes that the robot has sent."""
        self.robot.receive(data, now)
        self._look_for_failure()
        if self.robot.state is RobotSideState.SERVING:
            for client in [client for client in self.clients if client.is_open]:
                client.port.send(data)
            for client in self.clients:
                client.introduce(self.robot.identity)

    def robot_lost(self, why: str) -> None:
        """Note that the link to the robot does not open, or has failed."""
        self._say(f"the robot is lost: {why}")
        self._disconnect()
        self.robot.lose()

    def link_closed(self) -> None:
        """Note that the link to the robot has been closed."""
        self.robot.away()
        self._cut_off_until = inf

    def end(self, now: float) -> None:
        """End the session, and disconnect all hosts."""
        self._end(now)
        self._disconnect()

    def tick(self, now: float) -> None:
        """Act on the passing of time; harmless to call too often."""
        for client in self._undecided:
            if now >= client.joined_at + UNDECIDED:
                client.port.close()
                self.leave(client, now)
        if self.robot.state is RobotSideState.SERVING:
            self._watch(now)
        self.robot.tick(now)
        self._look_for_failure()

    def _look_for_failure(self) -> None:
        if self.robot.failure:
            self.robot_lost(self.robot.failure)

    def _watch(self, now: float) -> None:
        """Stop the robot if its holder is silent; let one that was cut off drive again."""
        if now >= self._cut_off_until:
            self._cut_off_until = inf
            self._guard.holds.discard(HeldBack.CUT_OFF)
        holder = self.holder
        if holder is None or not self._silence or not self._guard.moving:
            return
        if now >= holder.heard_at + self._silence:
            self._say(
                f"{holder.port.name} has been silent for {self._silence:g} s; the robot stops"
            )
            self._stop(now)

    def _stop(
        self,
        now: float,
        why: HeldBack | None = None,
        *,
        take_power: bool = False,
        hard: bool = False,
    ) -> None:
        if why is not None:
            self._guard.holds.add(why)
        if self.robot.state is RobotSideState.SERVING:
            self._guard.stopped()
            self.robot.brake(now, take_power=take_power, hard=hard)

    def _end(self, now: float, keep: BridgeClient | None = None) -> None:
        """Stop the robot, then close its session; disconnect all hosts of it but `keep`."""
        self.robot.end(now, moving=self._guard.moving)
        self._disconnect(keep)

    def _disconnect(self, keep: BridgeClient | None = None) -> None:
        """Disconnect the holder, and all watchers but `keep`."""
        gone = [c for c in self.clients if c is not keep and (c.is_open or c is self.holder)]
        self.holder = None
        for client in gone:
            self.clients.remove(client)
            client.port.close()
        self._guard = Guard()
