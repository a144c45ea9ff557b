"""Our own node passes, in every distribution and in both styles of several robots."""

import pytest

from pioneer3.doctor.facts import Level
from pioneer3.models import load_model
from pioneer3.ros.checks.check import check
from pioneer3.ros.checks.facts import CheckReport
from pioneer3.ros.checks.listening import TopicListener
from pioneer3.ros.ros2.backend import NodeName
from tests.unit.ros.checks.robot import CHECK
from tests.unit.ros.ros2.memory import MemoryBackend
from tests.unit.ros.ros2.test_node import a_node


async def checked(
    *words: str,
    node: NodeName,
    distro: str = "jazzy",
    serves: bool = True,
) -> CheckReport:
    """Return the report of a simulated robot's node."""
    async with a_node(*words, node=node, distro=distro, serves=serves) as the:
        backend = MemoryBackend(the.network, CHECK)
        listener = TopicListener(
            backend,
            CHECK,
            the.types,
            node,
            transducers=len(load_model("p3at-sh").sonars),
            wall=the.now,
        )
        await listener.listen(4.0, lambda line: None)
        return check(listener.facts())


@pytest.mark.parametrize("distro", ["humble", "jazzy", "kilted", "lyrical"])
async def test_our_node_is_all_right(distro: str) -> None:
    report = await checked(node=NodeName("pioneer3", "/robot1"), distro=distro)
    assert [each for each in report.rows if each.faults] == []
    assert report.count(Level.OK) > 30


async def test_our_node_is_all_right_without_services() -> None:
    report = await checked(node=NodeName("pioneer3"), serves=False)
    assert [each for each in report.rows if each.faults] == []


@pytest.mark.parametrize(
    ("footprint", "told"),
    [
        ("base_footprint", []),
        ("", ["child_frame_id is base"]),
    ],
)
async def test_names_of_frames_that_are_not_usual_are_told_once(
    footprint: str, told: list[str]
) -> None:
    words = ("base_frame_id:=base", "odom_frame_id:=start", f"footprint_frame_id:='{footprint}'")
    arguments = [word for each in words for word in ("-p", each)]
    report = await checked(*arguments, node=NodeName("pioneer3"))
    found = [fault.reason for each in report.rows for fault in each.faults]
    assert found == ["frame_id is start", *told]
    assert report.count(Level.FAIL) == 0
