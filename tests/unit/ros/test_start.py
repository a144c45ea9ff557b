from collections.abc import Sequence

import pytest

from pioneer3.doctor.ports import SerialPort
from pioneer3.doctor.probe import SIMULATOR_URL, Probed, ProbeVerdict
from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.ros.node import start
from pioneer3.ros.node.start import StartOptions, simulator_or_robot
from pioneer3.ros.ros1.start import serve

SERIAL = SerialPort(path="/dev/ttyS9", device="/dev/ttyS9")


def answering(monkeypatch: pytest.MonkeyPatch, **verdicts: ProbeVerdict) -> None:
    """Let the simulator's port and the only serial port have these verdicts."""

    async def probe(url: str) -> Probed:
        return Probed(url, verdicts["tcp"], "says why")

    async def probe_all(ports: Sequence[SerialPort]) -> list[Probed]:
        return [Probed(port.path, verdicts["serial"], "", port) for port in ports]

    monkeypatch.setattr(start, "probe", probe)
    monkeypatch.setattr(start, "probe_all", probe_all)
    monkeypatch.setattr(start, "list_ports", lambda: (SERIAL,))


@pytest.mark.parametrize("kind", [ProbeVerdict.SIMULATOR, ProbeVerdict.ROBOT])
async def test_without_a_port_the_usual_simulator_comes_first(
    kind: ProbeVerdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    answering(monkeypatch, tcp=kind, serial=ProbeVerdict.ROBOT)
    told: list[str] = []
    assert await simulator_or_robot(told.append) == SIMULATOR_URL
    assert told == []


async def test_without_a_simulator_it_is_the_robot_at_a_serial_port(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    answering(monkeypatch, tcp=ProbeVerdict.NOBODY, serial=ProbeVerdict.ROBOT)
    told: list[str] = []
    assert await simulator_or_robot(told.append) == SERIAL.path
    assert told == [f"no simulator at {SIMULATOR_URL} (says why); asks the serial ports"]


async def test_with_neither_it_says_how_to_get_one(monkeypatch: pytest.MonkeyPatch) -> None:
    answering(monkeypatch, tcp=ProbeVerdict.NOBODY, serial=ProbeVerdict.SILENT)
    with pytest.raises(NoRobotError, match="pioneer3 sim"):
        await simulator_or_robot(lambda line: None)


async def test_what_is_no_argument_of_ros_is_refused() -> None:
    with pytest.raises(ConfigError, match="'/dev/ttyS0' is none of ROS's arguments"):
        await serve(StartOptions(arguments=("/dev/ttyS0",)), lambda line: None)
