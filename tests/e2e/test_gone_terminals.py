"""Programs at a terminal that is gone, with hang-ups ignored, as under nohup. Real time."""

from pathlib import Path

import pytest

from tests.e2e.at_terminal import person
from tests.e2e.processes import until

pytestmark = pytest.mark.realtime

UP = b"\x1b[A"
ROLLS = 1.5
"""Farthest that a robot of 0.4 m/s comes on a slow machine [m]; its keys act for 4 m."""


@pytest.mark.parametrize(
    ("command", "ready", "keys"),
    [
        ("drive --latch --speed 0.4", b"Nothing is asked of it", UP),
        ("fleet drive --latch --speed 0.4", b"1 connected", UP),
        ("demo", b"motors enabled", UP * 10),
    ],
    ids=["drive", "fleet drive", "demo"],
)
async def test_a_terminal_that_is_gone_stops_the_robot_although_hang_ups_are_ignored(
    tmp_path: Path, command: str, ready: bytes, keys: bytes
) -> None:
    async with person(tmp_path, command=command, ready=ready, nohup=True) as the:
        the.type(keys)
        await until(lambda: the.speed > 0.2)
        travelled = the.travelled
        the.hang_up()
        await until(lambda: the.standing)
        assert the.travelled - travelled < ROLLS
        await the.code()
        assert not the.simulation.body.drive.powered
