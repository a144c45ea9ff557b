"""`pioneer3 config` with a simulated robot: shown, kept, compared, restored."""

import asyncio
import json

import pytest

from pioneer3.arcos import commands
from pioneer3.robot.config_backup import user_backups
from pioneer3.sim.body import Body
from pioneer3.sim.firmware.steering import steer
from pioneer3.sim.server.start import simulator
from tests.e2e.processes import pioneer3

pytestmark = pytest.mark.realtime


async def test_a_backup_is_compared_and_restored_as_far_as_a_host_may() -> None:
    async with simulator(port=0) as simulated:

        async def config(*words: str) -> tuple[int, str, str]:
            return await pioneer3("config", *words, "--port", simulated.url)

        assert (await config("diff"))[0] == 2
        assert (await config("backup"))[0] == 0
        assert await config("diff") == (0, "", "")
        shown = json.loads((await config("show", "--json"))[1])
        assert shown["accel_mm_s2"]["value"] == shown["accel_mm_s2"]["model"]["value"] == "300"
        (path,) = user_backups()
        text = path.read_text()
        edited = path.with_name(path.name.replace(".toml", ".2.toml"))
        edited.write_text(
            text.replace("\naccel_mm_s2 = 300", "\naccel_mm_s2 = 250")
            .replace("\nticks_per_mm = 128", "\nticks_per_mm = 130")
            .replace("watchdog_ms = 2000", "watchdog_ms = 900")
            .replace("rotation_kp_raw = 40", "rotation_kp_raw = 41")
        )
        code, out, _ = await config("diff")
        assert code == 1
        assert [line.split()[0] for line in out.splitlines() if line.startswith(" ")] == [
            "accel",
            "rotation_kp",
            "watchdog",
            "ticks_per_mm",
        ]
        code, out, _ = await config("restore")
        assert code == 1
        assert "accel: 250 mm/s²: set, was 300\n" in out
        assert "ticks_per_mm: 130 1/mm: set, was 128\n" in out
        assert "rotation_kp: 41: was sent, and not taken\n" in out
        assert "watchdog: 900 ms: only the maker's tool writes it; it is 2000\n" in out
        assert "switched off" in out
        assert (await pioneer3("config", "diff", edited.stem, path.name))[0] == 1
        edited.write_text(text.replace('"SIM"', '"99"'))
        code, _, err = await config("restore", str(edited))
        assert code == 2
        assert "not of this robot" in err


async def test_nothing_is_set_while_the_robot_moves() -> None:
    async with simulator(port=0) as simulated:
        assert (await pioneer3("config", "backup", "--port", simulated.url))[0] == 0
        body = simulated.robots[0].body
        driving = asyncio.create_task(_push(body))
        code, out, err = await pioneer3("config", "restore", "--port", simulated.url)
        driving.cancel()
        assert code == 1
        assert out == ""
        assert "while the robot moves" in err
        assert body.drive.linear.acceleration == pytest.approx(0.3)


async def _push(body: Body) -> None:
    """Turn a robot as somebody does who is not its host."""
    while True:
        body.enable_motors(on=True)
        steer(body, commands.RVel(rate=0.5))
        await asyncio.sleep(0.02)
