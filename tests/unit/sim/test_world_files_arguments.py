"""Robots and starts on the command line, laid over a world."""

from dataclasses import replace
from math import pi, radians

import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.worldfile import RobotSpec, Start, WorldFile
from pioneer3.sim.worldfile.arguments import WorldOverrides, parse_robot, parse_start

ALICE = RobotSpec(
    model="p3dx-sh", name="alice", port=9000, equipment=EquipmentOptions(gripper=True)
)
BOB = RobotSpec(model="p3at-sh", name="bob", start=Pose2(1.0, 2.0))
LAB = WorldFile(name="lab", seed=3, robots=(ALICE, BOB))


@pytest.mark.parametrize(
    ("text", "model", "name"),
    [
        ("p3at", "p3at", ""),
        ("p3dx:bob", "p3dx", "bob"),
        ("p3dx:bob the 2nd", "p3dx", "bob the 2nd"),
        ("params/mine.p", "params/mine.p", ""),
        ("params/mine.p:eve", "params/mine.p", "eve"),
        ("odd:folder/mine.toml", "odd:folder/mine.toml", ""),
        ("odd:mine.p", "odd:mine.p", ""),
        ("odd:folder/mine.toml:eve", "odd:folder/mine.toml", "eve"),
    ],
)
def test_a_robot_is_a_model_and_perhaps_a_name(text: str, model: str, name: str) -> None:
    assert parse_robot(text) == RobotSpec(model=model, name=name)


def test_a_start_may_carry_units() -> None:
    assert parse_start("1m,2m,90deg") == Pose2(1.0, 2.0, pi / 2)
    assert parse_start("50cm, -1.5, 1rad") == Pose2(0.5, -0.0015, 1.0)


@pytest.mark.parametrize("text", ["", ":bob", "p3dx:", "p3dx:a\nb", "p3dx:" + "x" * 41])
def test_what_is_no_robot_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match=r"^--robot .*p3dx:bob") as caught:
        parse_robot(text)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("word", ["home", "random", "outside"])
def test_a_start_may_be_a_word(word: str) -> None:
    assert parse_start(word) == word


def test_a_start_may_be_millimetres_and_degrees_as_in_mobilesim() -> None:
    assert parse_start("3000,-3100,90") == Pose2(3.0, -3.1, pi / 2)
    assert parse_start("0,0.5,-450") == Pose2(0.0, 0.0005, radians(-90))
    assert parse_start(" 1 , 2 , 3 ") == Pose2(0.001, 0.002, radians(3))


@pytest.mark.parametrize("text", ["", "here", "1,2", "1,2,3,4", "1,2,x", "Random", "nan,0,0"])
def test_what_is_no_start_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match=r"^--start "):
        parse_start(text)


@pytest.mark.parametrize("text", ["1e9,0,0", "0,101000m,0", "0,-1e9,0"])
def test_a_start_off_the_earth_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match="not within 100 km"):
        parse_start(text)


def test_without_wishes_a_world_stays_as_it_is() -> None:
    assert WorldOverrides().applied_to(LAB) == LAB


def test_a_world_without_robots_gets_one() -> None:
    assert WorldOverrides().applied_to(WorldFile(name="w")).robots == (RobotSpec(),)


def test_robots_of_the_command_line_replace_the_worlds() -> None:
    eve = RobotSpec(model="p3at", name="eve")
    world = WorldOverrides(robots=(eve,)).applied_to(LAB)
    assert world.robots == (eve,)
    assert world.seed == 3


@pytest.mark.parametrize(
    ("starts", "expected"),
    [
        ((), ["home", Pose2(1.0, 2.0)]),
        (("random",), ["random", "random"]),
        (("outside", Pose2(5.0, 5.0)), ["outside", Pose2(5.0, 5.0)]),
    ],
)
def test_starts_are_for_all_or_for_each(starts: tuple[Start, ...], expected: list[Start]) -> None:
    assert [r.start for r in WorldOverrides(starts=starts).applied_to(LAB).robots] == expected


def test_a_number_of_starts_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ConfigError, match="--start: 3 given, but robots: 2; give one for all, or"):
        WorldOverrides(starts=("home", "home", "home")).applied_to(LAB)


def test_fittings_are_added_to_what_robots_have() -> None:
    world = WorldOverrides(equipment=EquipmentOptions(compass=True)).applied_to(LAB)
    assert [robot.equipment for robot in world.robots] == [
        EquipmentOptions(gripper=True, compass=True),
        EquipmentOptions(compass=True),
    ]


@pytest.mark.parametrize("asked", [False, True])
@pytest.mark.parametrize("said", [False, True])
def test_sessions_are_kept_where_either_says_so(*, asked: bool, said: bool) -> None:
    world = WorldOverrides(keep_session=asked).applied_to(replace(LAB, keep_session=said))
    assert world.keep_session == (asked or said)


def test_seed_and_ports_of_the_command_line_win() -> None:
    world = WorldOverrides(seed=0, own_ports=False).applied_to(LAB)
    assert world.seed == 0
    assert [robot.port for robot in world.robots] == [None, None]


def test_a_factory_needs_no_robot_and_keeps_those_there_are() -> None:
    overrides = WorldOverrides(
        factory="p3dx", starts=("random",), equipment=EquipmentOptions(compass=True)
    )
    assert overrides.applied_to(WorldFile(name="w")).robots == ()
    assert len(overrides.applied_to(LAB).robots) == 2
    assert overrides.factory_robot == RobotSpec(
        model="p3dx", start="random", port=0, equipment=EquipmentOptions(compass=True)
    )
    assert WorldOverrides().factory_robot is None
