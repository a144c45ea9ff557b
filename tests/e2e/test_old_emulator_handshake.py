"""Our driver and doctor against the old emulator's handshake, which forgives nothing."""

import asyncio

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.doctor.diagnose import diagnose, examine
from pioneer3.doctor.facts import Level, LinkFacts
from pioneer3.doctor.recognition import DeviceKind
from pioneer3.errors import NoRobotError
from pioneer3.links import Link
from pioneer3.links.memory import MemoryLink
from pioneer3.navigation.connect import connect_async
from tests.support import SYNCS, SimulatedRobot, Wire, frame, hold, until

STOP = frame(commands.Stop())
SYNC_FRAMES = [encode(bytes([number])) for number in SYNCS]
MOST_ATTEMPTS = 10
ANSWERS_AFTER = [0.0, 0.03, 0.16]
"""What the captures show [s]."""


class OldEmulator(SimulatedRobot):
    """A robot that shakes hands as the old emulator does (protocol.md 2.7, facts.md 9.1).

    The first packet counts as a SYNC, whatever its number: it is echoed, and the next number is
    awaited. Beyond 2 every packet is a command, of a session that never began: there is no answer
    and no report. CLOSE ends the connection, and so does the eleventh attempt; the next connection
    begins anew.

    Attributes:
        answers_after: How long it thinks [s].
    """

    answers_after = 0.0

    async def open(self) -> Link:
        """Lay a cable; nothing is remembered of the one before."""
        self._awaited, self._attempts, self._began = 0, 0, False
        self._packets = PacketReader()
        self.power_cycle()
        return await super().open()

    async def _listen(self, link: MemoryLink, wire: Wire) -> None:
        while data := await link.read():
            wire.chunks.append((self._clock(), data))
            await asyncio.sleep(self.answers_after)
            for payload in self._packets.feed(data):
                await self._take(link, payload)

    async def _take(self, link: MemoryLink, payload: bytes) -> None:
        number = payload[0]
        if self._awaited <= SYNCS[-1]:
            self._awaited, self._attempts = number + 1, self._attempts + 1
            if self._attempts > MOST_ATTEMPTS:
                await link.close()
            elif number == SYNCS[-1]:
                await self._begin(link)
            else:
                await link.write(encode(payload[:1]))
        elif self._began and number != SYNCS[-1]:
            self.firmware.receive(encode(payload), self._clock())
            await self._flush()
        elif number == commands.Close.ID:
            await link.close()

    async def _begin(self, link: MemoryLink) -> None:
        self._began = True
        self.firmware.receive(b"".join(SYNC_FRAMES), self._clock())
        self.firmware.device.outgoing()
        await link.write(encode(b"\x02AMRISim\0Pioneer\0p3at-sh\0"))


async def test_the_old_emulator_answers_the_first_number_and_then_no_more() -> None:
    async with OldEmulator() as emulator:
        link = await emulator.open()
        await link.write(STOP + b"".join(SYNC_FRAMES))
        assert await link.read() == STOP
        assert await link.read() == b""  # SYNC2 is CLOSE to it


@pytest.mark.parametrize("answers_after", ANSWERS_AFTER)
async def test_our_driver_connects_to_the_old_emulator_and_drives_it(answers_after: float) -> None:
    async with OldEmulator() as emulator:
        emulator.answers_after = answers_after
        async with connect_async(emulator.open) as driver:
            assert driver.info.identity.name == "AMRISim"
            await hold(driver, 0.3)
            assert emulator.speed > 0.2
        await until(lambda: emulator.speed == 0)


async def test_our_driver_finds_the_old_emulator_again_after_a_lost_link() -> None:
    async with OldEmulator() as emulator, connect_async(emulator.open) as driver:
        await hold(driver, 0.3)
        await emulator.unplug()
        await asyncio.sleep(3.0)
        emulator.plugged = True
        async for snapshot in driver.snapshots(10):
            if snapshot.link.sessions == 2:
                break
        await asyncio.sleep(0.6)
        assert await hold(driver, 0.3) == 0
        assert emulator.speed > 0.2


@pytest.mark.parametrize("answers_after", ANSWERS_AFTER)
async def test_the_doctor_finds_the_old_emulator_healthy(answers_after: float) -> None:
    async with OldEmulator() as emulator:
        emulator.answers_after = answers_after
        facts = await examine(await emulator.open(), 2.0, LinkFacts(url="memory:robot"))
    findings = {finding.check: finding for finding in diagnose(facts)}
    assert findings["answer"].found.startswith("SIMULATOR AMRISim")
    assert Level.FAIL not in {finding.level for finding in findings.values()}


async def test_the_doctor_knows_an_old_emulator_that_somebody_confused() -> None:
    async with OldEmulator() as emulator:
        link = await emulator.open()
        await link.write(STOP)
        facts = await examine(link, 1.0, LinkFacts(url="memory:robot"))
    assert facts.other_device is not None
    assert facts.other_device.kind is DeviceKind.PACKETS
    answer = next(finding for finding in diagnose(facts) if finding.check == "answer")
    assert "1 well-formed packet" in answer.found
    assert "AMRISim" in answer.meaning
    assert "make no sense" not in answer.found


async def test_without_a_handshake_the_driver_gives_up_with_a_reason() -> None:
    async with OldEmulator() as emulator:
        link = await emulator.open()
        await link.write(STOP)

        async def opened() -> Link:
            return link

        with pytest.raises(NoRobotError, match="speaks the robot's protocol, but"):
            async with connect_async(opened):
                pass
