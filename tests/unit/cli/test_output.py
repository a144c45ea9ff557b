"""Numbers as programs and people read them."""

from math import inf, nan, pi
from types import SimpleNamespace
from typing import Any

import pytest

from pioneer3.cli.live import line
from pioneer3.cli.process import write_json
from pioneer3.geometry import Pose2, Twist2
from pioneer3.navigation.connect import connect_async
from tests.support import SimulatedRobot


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (0.1 + 0.2, "0.3"),
        (-0.0, "0.0"),
        (-1e-9, "0.0"),
        (inf, "null"),
        (nan, "null"),
        ({"pose": Pose2(1 / 3, -1e-17, 2.0)}, '{"pose":{"x":0.333333,"y":0.0,"theta":2.0}}'),
        ((Twist2(0.1 * 3), "a", None, True, 3), '[{"v":0.3,"w":0.0},"a",null,true,3]'),
    ],
)
def test_json_has_no_digits_that_mean_nothing(
    value: object, written: str, capsys: pytest.CaptureFixture[str]
) -> None:
    write_json(value)
    assert capsys.readouterr().out == f"{written}\n"


async def test_a_robot_that_hardly_moves_backwards_does_not_have_minus_zero() -> None:
    async with SimulatedRobot(home=Pose2(0.0, 0.0, -1e-4)) as sim, connect_async(sim.open) as robot:
        robot.drive(-0.001)
        async for _ in robot.snapshots(0.4):
            assert "-0.00" not in line(robot)
            assert " -0°" not in line(robot)


async def test_a_place_is_told_on_the_map_while_that_is_sure() -> None:
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        knows: Any = SimpleNamespace(sure_odom_in_map=Pose2(5.0, 2.0, pi / 2))
        robot.navigator = knows
        assert "map x  5.00 y  2.00   90°" in line(robot)
        knows.sure_odom_in_map = None
        assert "map" not in line(robot)
        assert "x  0.00 y  0.00    0°" in line(robot)
        robot.navigator = None
