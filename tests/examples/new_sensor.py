"""Run by `test_extend.py` with a package that has one more sensor, `gauge`."""

import asyncio
from types import SimpleNamespace

from pioneer3.models import load_model
from pioneer3.ros.messages.update import MessageOptions, SensorUpdate
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.topics import published
from tests.unit.web.browser import Browser, product


async def test_it_reads_the_charge_while_somebody_wants_it() -> None:
    async with product() as the:
        reading = await the.robot.devices.gauge.reading()  # type: ignore[attr-defined]
        assert 0.5 < reading.charge <= 1.0


async def test_the_page_shows_it() -> None:
    async with product() as the, Browser(the.app) as page:
        await the.robot.devices.gauge.reading()  # type: ignore[attr-defined]
        page.say("watch_details", on=True)
        await asyncio.sleep(1.5)
        shown = {each["name"]: each for each in page.latest("details")["sensors"]}["gauge"]
        assert shown["values"][0]["label"] == "charge"
        assert shown["values"][0]["text"].endswith(" %")


def test_ros_has_a_topic_for_it() -> None:
    topics = published(load_model("p3at-sh"), MessageOptions(), Profile.STANDARD)
    (topic,) = (topic for topic in topics if topic.sensor == "gauge")
    message = SimpleNamespace()
    assert topic.fill is not None
    reading = SimpleNamespace(charge=0.75)
    topic.fill(message, SensorUpdate(reading=reading, frames=MessageOptions().frames, stamp=None))
    assert (topic.standard, message.data) == ("charge", 0.75)
