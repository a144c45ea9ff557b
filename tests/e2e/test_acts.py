"""The ACTS client against the simulator's server, and against what is none."""

import asyncio
from contextlib import aclosing

import pytest

from pioneer3.acts import BlobPicture, encode
from pioneer3.errors import DeviceError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.links import Link
from pioneer3.links.memory import MemoryLink, null_modem
from pioneer3.robot.devices.acts import Acts
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import Box, RobotSpec, WorldFile

WORLD = WorldFile(
    name="two boxes",
    robots=(
        RobotSpec(model="p3dx-sh", start=ORIGIN, equipment=EquipmentOptions(camera="sony")),
        RobotSpec(model="p3dx-sh", start=Pose2(-3, 0, 0)),
    ),
    boxes=(Box(pose=Pose2(3, 0.4, 0), size=(0.5, 0.5), movable=True),),
)


async def one_picture(acts: Acts) -> BlobPicture:
    async with asyncio.timeout(10), aclosing(acts.pictures()) as pictures:
        return await anext(pictures)


@pytest.mark.realtime
class TestTheSimulatorsServer:
    async def test_each_robot_sees_what_is_before_it(self) -> None:
        async with simulator(map_name=WORLD, port=0, acts=0) as running:
            first, second = [await one_picture(Acts(url)) for url in running.acts_urls]
        (box,) = first.channel(2)
        assert box.right < 80
        assert not first.channel(3)
        assert second.channel(3)

    async def test_pictures_go_on_and_the_world_is_seen_to_change(self) -> None:
        async with simulator(map_name=WORLD, port=0, acts=0) as running:
            acts = Acts(running.acts_urls[0])
            async with asyncio.timeout(10), aclosing(acts.pictures()) as pictures:
                before = await anext(pictures)
                running.move(running.world.obstacles[0], Pose2(3, -0.4, 0))
                after = await anext(pictures)
                assert acts.presence.there
        assert before.channel(2)[0].x < 80 < after.channel(2)[0].x

    async def test_it_is_off_unless_asked_for(self) -> None:
        async with simulator(map_name=WORLD, port=0) as running:
            assert running.acts_urls == []

    async def test_quit_ends_the_connection_and_nonsense_is_ignored(self) -> None:
        async with simulator(map_name=WORLD, port=0, acts=0) as running:
            host, _, port = running.acts_urls[0].removeprefix("tcp://").rpartition(":")
            reader, writer = await asyncio.open_connection(host, int(port))
            async with asyncio.timeout(10):
                writer.write(b"hello\r\n0")
                assert len(await reader.readexactly(128)) == 128
                writer.write(b"1")
                await reader.read()
            writer.close()
            assert (await one_picture(Acts(running.acts_urls[0]))).channel(2)

    async def test_nobody_there_is_said_in_words(self) -> None:
        async with simulator(map_name=WORLD, port=0, acts=0) as running:
            url = running.acts_urls[0]
        acts = Acts(url)
        with pytest.raises(DeviceError, match="does it run"):
            await one_picture(acts)
        assert acts.presence.there is False


class Far:
    """The far end of a cable to a client."""

    def __init__(self) -> None:
        ours, self.link = null_modem()
        self._ours: MemoryLink = ours

    async def open(self) -> Link:
        return self._ours


async def test_a_silent_server_is_said_in_words() -> None:
    acts = Acts(Far().open)
    with pytest.raises(DeviceError, match="no picture for 2 s"):
        await anext(acts.pictures())
    assert acts.presence.there is False


async def test_something_else_is_not_taken_for_acts() -> None:
    far = Far()
    await far.link.write(b"HTTP/1.1 400 Bad Request\r\n" * 10)
    with pytest.raises(DeviceError, match="not ACTS"):
        await anext(Acts(far.open).pictures())


async def test_one_that_goes_away_is_said_in_words() -> None:
    far = Far()
    acts = Acts(far.open)
    pictures = acts.pictures()
    await far.link.write(encode({}))
    await anext(pictures)
    await far.link.close()
    with pytest.raises(DeviceError, match="ACTS"):
        await anext(pictures)
    assert acts.latest is None
