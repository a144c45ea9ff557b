"""Bytes of a tick leave a simulated serial line little by little. Virtual time."""

import asyncio

from pioneer3.sim.server.serial_output import MOST, PIECES, STEP, SerialOutput


class Terminal:
    """A client that notes what is sent to it, and when [s]."""

    def __init__(self) -> None:
        self.sent: list[tuple[float, bytes]] = []

    def send(self, data: bytes) -> None:
        """Note it."""
        self.sent.append((asyncio.get_running_loop().time(), data))

    @property
    def bytes(self) -> bytes:
        """All that was sent."""
        return b"".join(data for _, data in self.sent)


async def test_a_tick_is_spread_over_the_time_until_the_next_one() -> None:
    terminal, output = Terminal(), SerialOutput()
    ticks = [bytes(range(n, n + 77)) for n in range(4)]
    for data in ticks:
        output.send(terminal, data)  # type: ignore[arg-type]
        await asyncio.sleep(PIECES * STEP)
    await asyncio.sleep(STEP)
    times = [when for when, _ in terminal.sent]
    assert terminal.bytes == b"".join(ticks)
    assert max(b - a for a, b in zip(times, times[1:], strict=False)) < 1.5 * STEP


async def test_where_time_flies_nothing_waits() -> None:
    terminal, output = Terminal(), SerialOutput()
    for _ in range(10 * MOST):
        output.send(terminal, b"0123456789")  # type: ignore[arg-type]
    assert len(terminal.bytes) >= 10 * (10 * MOST - MOST)


async def test_bytes_for_a_host_that_has_gone_are_forgotten() -> None:
    gone, output = Terminal(), SerialOutput()
    output.send(gone, b"0123456789")  # type: ignore[arg-type]
    output.clear()
    await asyncio.sleep(1.0)
    assert gone.bytes == b"01"
    here = Terminal()
    output.send(gone, b"0123456789")  # type: ignore[arg-type]
    output.send(here, b"abcdefghij")  # type: ignore[arg-type]
    await asyncio.sleep(1.0)
    assert here.bytes == b"abcdefghij"
