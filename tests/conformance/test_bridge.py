"""Sessions of real ARIA programs through a bridge: they must not notice it."""

import asyncio
from pathlib import Path

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.packet import PacketReader
from pioneer3.bridge import Bridge
from pioneer3.links.tap import FROM_HOST, read_recording
from pioneer3.tasks import running
from tests.support import SimulatedRobot

FOLDER = Path(__file__).parents[2].parent / "shared" / "captures"
CAPTURES = sorted(FOLDER.glob("*.txt"))

pytestmark = pytest.mark.skipif(not CAPTURES, reason="no captures beside this checkout")
HANDSHAKE = 4
"""SYNC0, SYNC1, SYNC2 and OPEN: the bridge itself has said them to the robot."""


@pytest.mark.parametrize("capture", CAPTURES, ids=lambda path: path.stem)
async def test_a_session_of_aria_is_passed_on_and_never_stopped(capture: Path) -> None:
    chunks = [chunk for chunk in read_recording(capture) if chunk.way == FROM_HOST]
    said = PacketReader().feed(b"".join(chunk.data for chunk in chunks))
    told: list[str] = []
    heard = bytearray()
    async with SimulatedRobot(model="p3at") as robot:
        bridge = Bridge(robot.open, say=told.append)
        async with running(bridge.run()):
            link = bridge.link("ARIA")

            async def listen() -> None:
                while data := await link.read():
                    heard.extend(data)

            clock = asyncio.get_running_loop().time
            async with running(listen()):
                began = clock() - chunks[0].time
                for chunk in chunks:
                    await asyncio.sleep(max(0.0, began + chunk.time - clock()))
                    await link.write(chunk.data)
                await asyncio.sleep(2.0)
        arrived = PacketReader().feed(robot.wires[-1].data)
    own = PacketReader().feed(bytes(heard))
    assert [payload[0] for payload in own[:3]] == [0, 1, 2]
    assert own[2].startswith(b"\2MobileSim\0Pioneer\0")
    before_close = [payload for payload in said[HANDSHAKE:] if payload[0] != commands.Close.ID]
    place = _find(arrived, before_close)
    assert place >= 0, "what ARIA sent did not arrive in one piece"
    assert told == ["ARIA has the robot", "ARIA has closed its session"]
    assert not robot.powered


def _find(arrived: list[bytes], wanted: list[bytes]) -> int:
    """Return where `wanted` is in `arrived`, in one piece; -1 if it is not."""
    places = range(len(arrived) - len(wanted) + 1)
    return next((at for at in places if arrived[at : at + len(wanted)] == wanted), -1)
