"""A cable in memory behaves like a real one, faults included."""

import asyncio
from random import Random

import pytest

from pioneer3.errors import LinkError
from pioneer3.links.memory import MemoryLink, null_modem
from tests.faults import Noise, bytewise


async def test_what_one_end_writes_the_other_reads() -> None:
    ours, theirs = null_modem()
    await ours.write(b"to robot")
    await theirs.write(b"to host")
    assert (await theirs.read(), await ours.read()) == (b"to robot", b"to host")


@pytest.mark.parametrize("closer", [0, 1])
async def test_closing_either_end_ends_both(closer: int) -> None:
    ends = null_modem()
    await ends[closer].close()
    await ends[closer].close()
    for end in ends:
        assert await end.read() == b""
        assert await end.read() == b""
        with pytest.raises(LinkError, match="the far end has closed"):
            await end.write(b"x")


async def test_what_was_sent_before_closing_still_arrives() -> None:
    ours, theirs = null_modem()
    await ours.write(b"last words")
    await ours.close()
    assert await theirs.read() == b"last words"
    assert await theirs.read() == b""


async def test_bytes_to_a_closed_end_vanish() -> None:
    ours, theirs = null_modem()
    await theirs.close()
    await ours.write(b"x")
    assert await ours.read() == b""


async def test_an_end_without_a_cable_fails() -> None:
    with pytest.raises(LinkError):
        await MemoryLink("memory:loose").write(b"x")


async def test_bytewise_comes_one_at_a_time() -> None:
    ours, theirs = null_modem(bytewise)
    await ours.write(b"abc")
    assert [await theirs.read() for _ in range(3)] == [b"a", b"b", b"c"]


async def test_a_delay_holds_bytes_and_the_hang_up_alike() -> None:
    clock = asyncio.get_running_loop().time
    ours, theirs = null_modem()
    ours.delay = 0.5
    await ours.write(b"x")
    await ours.close()
    assert await theirs.read() == b"x"
    assert await theirs.read() == b""
    assert clock() == pytest.approx(0.5)


async def test_ends_of_different_speed_hear_noise() -> None:
    ours, theirs = null_modem(speeds=(9600, 38400))
    await theirs.set_speed(38400)
    await ours.write(b"\xfa\xfb\x03\x00\x00\x00")
    assert b"\xfa\xfb" not in await theirs.read()
    await ours.set_speed(38400)
    await ours.write(b"\xfa\xfb")
    assert await theirs.read() == b"\xfa\xfb"


def test_noise_spoils_and_drops_the_share_it_is_told_to() -> None:
    sent = bytes(20_000)
    (got,) = Noise(Random(1), corrupt=0.1)(sent)
    assert len(got) == len(sent)
    assert sum(byte != 0 for byte in got) == pytest.approx(2000, rel=0.1)
    (got,) = Noise(Random(1), drop=0.1)(sent)
    assert len(got) == pytest.approx(18_000, rel=0.02)
    assert Noise(Random(1), drop=1.0)(sent) == ()


def test_the_same_chance_gives_the_same_noise() -> None:
    first, second = (Noise(Random(7), corrupt=0.5)(bytes(100)) for _ in range(2))
    assert first == second
