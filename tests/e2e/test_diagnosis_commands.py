"""`pioneer3 info`, `monitor` and `doctor` as people and programs run them."""

import json
from math import isclose

import pytest

from pioneer3.arcos.device import Device
from pioneer3.sim.firmware import controller
from pioneer3.sim.server.start import simulator
from pioneer3.state import Identity
from tests.e2e.processes import pioneer3
from tests.support import is_at

pytestmark = pytest.mark.realtime

FORGED = "x\x1b[2J\x9b1mready\r"


async def test_info_prints_json_and_nothing_else() -> None:
    async with simulator(port=0) as simulated:
        code, out, err = await pioneer3("info", "--json", "--port", simulated.url)
    told = json.loads(out)
    assert (code, err) == (0, "")
    assert told["kind"] == "SIMULATOR"
    assert told["identity"]["model"] == told["config"]["model"] == "p3at-sh"
    assert told["limits"]["max_speed"] > 0
    assert told["battery"]["voltage"] > 10


@pytest.mark.parametrize("command", ["info", "doctor", "monitor --seconds 1", "turn 5"])
async def test_no_terminal_obeys_a_robot(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(controller, "SERIAL_NUMBER", FORGED)
    async with simulator(port=0) as simulated:
        firmware = simulated.robots[0].firmware
        firmware.identity = Identity(name=FORGED, family=FORGED, model=FORGED)
        firmware.device = Device(firmware.identity, 2.0)
        code, out, err = await pioneer3(*command.split(), "--port", simulated.url)
    shown = out + err
    assert "unknown robot type" in shown or "not known here" in shown, (code, shown)
    assert shown.replace("\n", "").isprintable()


async def test_monitor_prints_a_reading_a_line_and_moves_nothing() -> None:
    async with simulator(port=0) as simulated:
        before = simulated.body.robot_in_world
        code, out, _ = await pioneer3("monitor", "--json", "--seconds", "1", "-p", simulated.url)
        assert is_at(simulated.body.robot_in_world, before)
        assert not simulated.body.drive.powered
    readings = [json.loads(line) for line in out.splitlines()]
    sequence = [reading["snapshot"]["sequence"] for reading in readings]
    assert code == 0
    assert 5 <= len(readings) <= 11
    assert sequence == sorted(sequence)
    assert not any(reading["snapshot"]["motors"]["enabled"] for reading in readings)
    stamps = [reading["snapshot"]["stamp"] for reading in readings]
    assert isclose((stamps[-1] - stamps[0]) / (len(stamps) - 1), 0.1, abs_tol=0.05)


async def test_monitor_without_a_terminal_prints_plain_lines() -> None:
    async with simulator(port=0) as simulated:
        code, out, _ = await pioneer3("monitor", "--seconds", "0.5", "-p", simulated.url)
    assert code == 0
    assert all(line.startswith("#") and "motors off" in line for line in out.splitlines())
    assert "\x1b" not in out


async def test_monitor_raw_shows_every_report_from_the_first_handshake_on() -> None:
    async with simulator(port=0) as simulated:
        code, out, _ = await pioneer3("monitor", "--raw", "--seconds", "0.5", "-p", simulated.url)
    kinds = [line.split()[2] for line in out.splitlines()]
    assert code == 0
    assert kinds[:3] == ["SyncEcho", "SyncEcho", "SyncIdentity"]
    assert "Config" in kinds
    assert kinds.count("Sip") >= 4


async def test_doctor_finds_a_simulator_healthy() -> None:
    async with simulator(port=0) as simulated:
        code, out, err = await pioneer3("doctor", "--seconds", "1", "-p", simulated.url)
    assert (code, err) == (0, "")
    assert "SIMULATOR MobileSim" in out
    assert "FAIL" not in out


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("doctor", "-p", "/dev/no-such-port"), 3),
        (("info", "-p", "/dev/no-such-port"), 3),
        (("monitor", "-p", "tcp://127.0.0.1:9"), 3),
        (("doctor", "-p", "nonsense"), 2),
    ],
)
async def test_exit_codes_tell_a_missing_robot_from_a_wrong_option(
    arguments: tuple[str, ...], expected: int
) -> None:
    code, _, err = await pioneer3(*arguments)
    assert code == expected
    assert "Traceback" not in err
