"""`pioneer3 find-port`: what is shown, and what is left for a program."""

import json

import pytest

from pioneer3.cli.diagnosis import find_port
from pioneer3.cli.tables import advice
from pioneer3.doctor import ports, probe
from pioneer3.doctor.ports import SerialPort
from pioneer3.doctor.probe import Probed, ProbeVerdict

ADAPTER = SerialPort(
    path="/dev/serial/by-id/usb-FTDI_A1", device="/dev/ttyUSB0", manufacturer="FTDI", product="R"
)


@pytest.fixture
def one_adapter(monkeypatch: pytest.MonkeyPatch) -> None:
    """A computer with one serial adapter."""
    monkeypatch.setattr(ports, "list_ports", lambda: (ADAPTER,))


@pytest.mark.usefixtures("one_adapter")
def test_listing_shows_the_stable_name_and_the_device_and_asks_nobody(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert find_port(no_probe=True) == 0
    out = capsys.readouterr().out
    assert "/dev/serial/by-id/usb-FTDI_A1" in out
    assert "/dev/ttyUSB0" in out
    assert "--port" not in out


@pytest.mark.usefixtures("one_adapter")
def test_json_is_all_there_is_on_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    assert find_port(no_probe=True, json=True) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["use"] is None
    assert report["ports"][0]["url"] == ADAPTER.path
    assert report["ports"][0]["port"]["device"] == "/dev/ttyUSB0"
    assert report["ports"][1]["url"] == "tcp://localhost:8101"


@pytest.mark.realtime
@pytest.mark.usefixtures("one_adapter")
def test_without_a_robot_the_exit_code_is_3(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(probe, "SIMULATOR_URL", "tcp://127.0.0.1:9")
    assert find_port() == 3
    captured = capsys.readouterr()
    assert "No robot found" in captured.out
    assert captured.err == ""


def test_the_option_to_use_is_spelt_out() -> None:
    found = [
        Probed("tcp://localhost:8101", ProbeVerdict.SIMULATOR),
        Probed(ADAPTER.path, ProbeVerdict.ROBOT),
    ]
    text = advice(found).plain
    assert f"Use: --port {ADAPTER.path}" in text
    assert "a SIMULATOR runs too" in text


def test_a_simulator_is_never_passed_off_as_a_robot() -> None:
    text = advice([Probed("tcp://localhost:8101", ProbeVerdict.SIMULATOR)]).plain
    assert "a SIMULATOR; no real robot answers" in text


def test_the_option_for_each_laser_is_spelt_out_beside_that_of_the_robot() -> None:
    laser = Probed("/dev/ttyACM0", ProbeVerdict.LASER, "Hokuyo")
    both = advice([Probed("/dev/ttyUSB0", ProbeVerdict.ROBOT), laser]).plain
    assert "Use: --port /dev/ttyUSB0\nThe laser: --laser /dev/ttyACM0" in both
    assert "--laser /dev/ttyACM0" in advice([laser]).plain


def test_without_a_robot_the_most_promising_port_goes_to_the_doctor() -> None:
    found = [
        Probed("/dev/ttyS0", ProbeVerdict.SILENT),
        Probed("/dev/ttyUSB0", ProbeVerdict.NO_PERMISSION),
    ]
    assert "Why not: p3 doctor -p /dev/ttyUSB0\n" in advice(found).plain
    nobody = [Probed("tcp://localhost:8101", ProbeVerdict.NOBODY)]
    assert "Why not: p3 find-port --wait\nWithout a robot: p3 sim" in advice(nobody).plain
