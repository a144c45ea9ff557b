"""The one place for a host at a robot: who has it, who waits for it, who is turned away.

Rules:

1. A second host is turned away, unless the first leaves within :data:`GRACE`, or has been silent,
   or has sent more than can be taken, for :data:`STALE`.
2. Of several at once one waits and the others are turned away.
3. A standing line, such as a serial one, takes a free place by its first word.
"""

import asyncio
import logging
from collections.abc import Callable
from math import inf

from pioneer3.sim.server.clients import Client

log = logging.getLogger(__name__)

STALE = 2.0
"""A host that has been silent for this long [s] loses its place to the next one."""
GRACE = 0.1
"""A host that has just left may not have been noticed when the next one is here [s, real]."""


class Seat:
    """Where one host sits.

    Args:
        on_change: Called when another host sits down, before it is listened to.
        robot: Returns what to call the robot in the log.

    Attributes:
        host: Who sits here.
        closed: Everybody is turned away.
    """

    def __init__(
        self, on_change: Callable[[], None], robot: Callable[[], str] = lambda: "a robot"
    ) -> None:
        self.host: Client | None = None
        self.closed = False
        self._on_change = on_change
        self._robot = robot
        self._waiting: Client | None = None
        self._heard_at = -inf
        self._flooded_at = inf

    @property
    def full(self) -> bool:
        """Whether one more host would be turned away at once."""
        return self.closed or (self._waiting is not None and not self._is_free())

    def admit(self, client: Client) -> None:
        """Give `client` the place, now or soon, or turn it away."""
        if self.closed:
            client.close()
        elif self._is_free():
            self._sit_down(client)
        elif self._waiting is None:
            self._waiting = client
            asyncio.get_running_loop().call_later(GRACE, self._decide, client)
        else:
            self._turn_away(client)

    def speaks(self, client: Client) -> bool:
        """Take note that `client` has said something; return whether it is heard here."""
        if client is not self.host:
            if not client.standing or self.closed or not self._is_free():
                return False
            self._sit_down(client)
        self._heard_at = _now()
        return True

    def flooded(self, *, flooded: bool) -> None:
        """Take note whether the host has sent more than can be taken."""
        self._flooded_at = min(self._flooded_at, _now()) if flooded else inf

    def leave(self, client: Client) -> bool:
        """Take note that `client` has gone; return whether it was the host."""
        if client is self._waiting:
            self._waiting = None
        if client is not self.host:
            return False
        log.info("%s: gone from %s", client.peer, self._robot())
        self.host = None
        if self._waiting is not None:
            waiting, self._waiting = self._waiting, None
            self._sit_down(waiting)
        return True

    def clear(self) -> None:
        """Part from everybody."""
        waiting, self._waiting = self._waiting, None
        for client in (waiting, self.host):
            if client is not None:
                client.close()
                self.leave(client)

    def _is_free(self) -> bool:
        since = min(self._heard_at, self._flooded_at)
        return self.host is None or _now() - since >= STALE

    def _sit_down(self, client: Client) -> None:
        last, self.host = self.host, client
        if last is not None:
            log.info("%s: silent or flooding, gives way at %s", last.peer, self._robot())
            last.close()
        log.info("%s: connected to %s", client.peer, self._robot())
        self._heard_at, self._flooded_at = _now(), inf
        self._on_change()
        client.resume()

    def _decide(self, client: Client) -> None:
        if client is not self._waiting:
            return
        self._waiting = None
        if self._is_free():
            self._sit_down(client)
        else:
            self._turn_away(client)

    def _turn_away(self, client: Client) -> None:
        log.info("%s: turned away from %s, another host is there", client.peer, self._robot())
        client.close()


def _now() -> float:
    return asyncio.get_running_loop().time()
