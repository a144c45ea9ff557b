"""The curl examples of the reference run against a simulated robot."""

import asyncio
import re
import shutil
from pathlib import Path

import pytest

from pioneer3 import connect_async
from pioneer3.maps import shipped_map
from pioneer3.web.access.sessions import Role, SessionKind
from pioneer3.web.api.routes import OPERATIONS
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import serve
from tests.cameras import fake_camera, films
from tests.support import SimulatedRobot

REFERENCE = Path(__file__).parents[2] / "docs/reference/http-api.md"
EXAMPLES = [
    example
    for example in re.findall(r"```sh\n(.*?)```", REFERENCE.read_text(), re.DOTALL)
    if "$API/class" not in example  # those run in tests/e2e/test_class.py
]
OFFICE = shipped_map("office")
PATIENCE = 60.0

pytest.importorskip("numba")
pytest.importorskip("scipy")
pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(shutil.which("curl") is None, reason="curl is not installed"),
]


@pytest.mark.parametrize("example", EXAMPLES, ids=range(len(EXAMPLES)))
async def test_an_example_of_the_reference_runs(example: str, tmp_path: Path) -> None:
    async with (
        fake_camera(films((200, 30, 30))) as camera,
        SimulatedRobot(OFFICE, home=OFFICE.homes[0]) as sim,
        connect_async(sim.open, camera=camera.url) as robot,
        (page := Page()).hosting(robot, RobotScene(map=OFFICE, odom_in_map=OFFICE.homes[0])),
        serve(page, port=0) as served,
    ):
        _, token = page.access.sessions.open("survey", Role.DRIVER, SessionKind.SCRIPT)
        bash = await asyncio.create_subprocess_exec(
            "bash",
            "-euo",
            "pipefail",
            "-c",
            example.replace("http://127.0.0.1:8080", served.http),
            env={"TOKEN": token, "PATH": "/usr/local/bin:/usr/bin:/bin"},
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            cwd=tmp_path,
        )
        async with asyncio.timeout(PATIENCE):
            out, err = await bash.communicate()
        assert bash.returncode == 0, err.decode()
        assert out.startswith((b"[", b"{"))
        if "for i in" in example:
            assert sim.body.robot_in_world.x - OFFICE.homes[0].x > 0.05


def test_every_operation_on_robots_is_in_the_reference() -> None:
    text = REFERENCE.read_text()
    for one in OPERATIONS:
        if "{robot}" in one.path:
            assert one.path.replace("/api", "$API").replace("{robot}", "1") in text
