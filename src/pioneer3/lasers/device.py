"""The laser's side, as the simulator drives it, whatever the protocol. No I/O.

A :class:`LaserDevice` is one unit: its settings, its mirror, its line. It tells the
:class:`MirrorTurn` that its mirror makes next; who has the physics hands the :class:`Sweep` in when
the turn is over. Each host has a :class:`DeviceConnection`; a unit on a serial line has one for
ever, whoever opens the port. A host that reaches such a line through a network finds it empty.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True, kw_only=True)
class MirrorTurn:
    """One turn of the mirror: the readings that it takes.

    The direction of the first one and the step to the next are in [rad], `beam_time` to the next
    and `period`, of the whole turn with the part that measures nothing, in [s].
    """

    first: float
    step: float
    count: int
    beam_time: float
    period: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """The readings of one turn, the first of them taken when it `began` [s].

    `ranges`, shape (count,), are in [m], with the errors of the laser; `inf` where nothing came
    back. `intensities`, likewise, are shares of the light of a perfect matt white wall, more for
    reflectors, 0 where nothing came back. `echoes` are all of each reading [m], the nearest first,
    shape (count, up to 3); empty where there is never more than one. `millimetres` are the ranges,
    rounded, from the `least` to the `most`; empty where they are not known yet.
    """

    turn: MirrorTurn
    began: float
    ranges: Sequence[float]
    intensities: Sequence[float]
    echoes: Sequence[tuple[float, ...]] = ()
    millimetres: Sequence[int] = ()
    least: int = 0
    most: int = 0


class DeviceConnection(Protocol):
    """One host at a device."""

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes of the host, in any pieces."""

    def outgoing(self, now: float) -> bytes:
        """Return and forget the bytes that may leave by `now`: no faster than the line's speed."""

    def close(self) -> None:
        """Take the end of a network connection; a serial line has none."""


class LaserDevice(Protocol):
    """One laser.

    `speed` is the line's [baud], `None` where there is no serial line; a host at another speed
    neither hears nor is heard. At `deadline` [s] :meth:`tick` has something to do, or bytes may
    leave; `inf`: never.
    """

    speed: int | None
    deadline: float

    @property
    def turn(self) -> MirrorTurn | None:
        """The mirror's next turn, or `None` while nobody wants readings."""

    def connect(self, *, network: bool = False) -> DeviceConnection:
        """Return the connection of one more host; over a `network`, to a serial line's server."""

    def measured(self, sweep: Sweep, now: float) -> None:
        """Take the readings of a turn whose last reading was taken at `now` [s].

        Bytes may have been exchanged for later times already, up to a tick of the simulator. Those
        of this turn leave from `now` on, behind the others.
        """

    def tick(self, now: float) -> None:
        """Act on the passing of time."""

    def switch_on(self, now: float) -> None:
        """Begin as after a power cycle: what is not stored is forgotten."""
