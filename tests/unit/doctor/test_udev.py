"""Rules for udev, and lasers at serial ports, from ports that are made up."""

from pathlib import Path

import pytest

from pioneer3.cli.setup import udev
from pioneer3.doctor import lasers, ports
from pioneer3.doctor.lasers import FoundLaser, find_laser, find_lasers
from pioneer3.doctor.ports import PortHolder, SerialPort
from pioneer3.doctor.udev import rules, written
from pioneer3.errors import ConfigError, PortNotFoundError
from pioneer3.models.lasers import LaserProtocol

HOKUYO = SerialPort(
    path="/dev/serial/by-id/usb-Hokuyo_URG",
    device="/dev/ttyACM0",
    vendor_id=0x15D1,
    product_id=0x0000,
    product="URG-Series USB Driver",
)
FTDI = SerialPort(
    path="/dev/serial/by-id/usb-FTDI_A1",
    device="/dev/ttyUSB0",
    vendor_id=0x0403,
    product_id=0x6001,
    serial_number="A1 2/B",
)
PROLIFIC = SerialPort(
    path="/dev/ttyUSB1",
    device="/dev/ttyUSB1",
    vendor_id=0x067B,
    product_id=0x2303,
    socket="pci-0000:00:14.0-usb-0:2:1.0",
)
ON_BOARD = SerialPort(path="/dev/ttyS0", device="/dev/ttyS0")
SICK = FoundLaser(PROLIFIC.path, LaserProtocol.LMS2XX, "SICK LMS200")
PROGRAM = "/home/ann bell/.venv/bin/pioneer3"


def test_an_adapter_with_a_serial_number_is_known_by_it() -> None:
    (rule,) = rules([FTDI], PROGRAM)
    assert rule.text == (
        'ACTION=="add", SUBSYSTEM=="tty", ATTRS{idVendor}=="0403", ATTRS{idProduct}=="6001", '
        'ATTRS{serial}=="A1 2/B", GROUP="dialout", MODE="0660", SYMLINK+="pioneer3/serial-A1-2-B"'
    )


def test_an_adapter_without_one_is_known_by_its_socket() -> None:
    (rule,) = rules([PROLIFIC], PROGRAM)
    assert 'ENV{ID_PATH}=="pci-0000:00:14.0-usb-0:2:1.0"' in rule.text
    assert "serial}" not in rule.text
    assert rule.link == "pioneer3/serial-pci-0000-00-14.0-usb-0-2-1.0"


def test_lasers_are_asked_for_their_number_by_one_rule() -> None:
    (rule,) = rules([HOKUYO, HOKUYO], PROGRAM)
    assert "PROGRAM=\"'/home/ann bell/.venv/bin/pioneer3' laser id /dev/%k\"" in rule.text
    assert 'SYMLINK+="pioneer3/laser-%c"' in rule.text
    assert 'ATTRS{idVendor}=="15d1", ATTRS{idProduct}=="0000"' in rule.text


def test_ports_that_are_no_usb_have_no_rule() -> None:
    assert rules([ON_BOARD], PROGRAM) == ()
    assert len(rules([HOKUYO, FTDI, PROLIFIC, ON_BOARD], PROGRAM)) == 3


def test_every_rule_is_one_line_below_its_comment() -> None:
    text = written(rules([HOKUYO, FTDI, PROLIFIC], PROGRAM))
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    assert len(lines) == 3
    assert all(line.count('"') % 2 == 0 for line in lines)
    assert "# FTDI FT232R, serial number A1 2/B: /dev/pioneer3/serial-A1-2-B" in text


def test_the_command_shows_the_rules_and_what_to_do(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(ports, "list_ports", lambda: (FTDI,))
    assert udev() == 0
    shown = capsys.readouterr().out
    assert "pioneer3/serial-A1-2-B" in shown
    assert "--write 70-pioneer3.rules" in shown
    assert "sudo udevadm control --reload" in shown


def test_it_writes_a_file_if_asked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(ports, "list_ports", lambda: (FTDI, HOKUYO))
    file = tmp_path / "mine.rules"
    assert udev(write=file) == 0
    rule = rules([FTDI], "")[0]
    assert rule.text in file.read_text(encoding="utf-8")
    assert f"sudo cp {file} /etc/udev/rules.d/70-pioneer3.rules" in capsys.readouterr().out


def test_without_any_usb_port_it_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(ports, "list_ports", lambda: (ON_BOARD,))
    assert udev() == 1
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "no USB serial port" in captured.err


def busy(port: SerialPort) -> SerialPort:
    return SerialPort(path=port.path, device=port.device, holders=(PortHolder(7, "ModemManager"),))


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """A computer with these ports, with an LMS at the Prolific; return those that are asked."""
    heard: list[str] = []

    async def laser_at(url: str) -> FoundLaser | None:
        heard.append(url)
        return SICK if url == PROLIFIC.path else None

    monkeypatch.setattr(lasers, "laser_at", laser_at)
    monkeypatch.setattr(lasers, "list_ports", lambda: (HOKUYO, FTDI, PROLIFIC, busy(ON_BOARD)))
    return heard


async def test_lasers_are_found_and_nobody_elses_ports_are_touched(asked: list[str]) -> None:
    assert await find_lasers([FTDI.device, "tcp://localhost:8101"]) == (
        FoundLaser(HOKUYO.path, LaserProtocol.SCIP, "URG-Series USB Driver"),
        SICK,
    )
    assert sorted(asked) == sorted([HOKUYO.path, PROLIFIC.path])


async def test_one_laser_is_taken_and_several_are_named(asked: list[str]) -> None:
    assert await find_laser([HOKUYO.device]) == PROLIFIC.path
    with pytest.raises(
        ConfigError, match=r"several: .*Hokuyo_URG \(.*\), /dev/ttyUSB1 \(SICK LMS200\); choose one"
    ):
        await find_laser()


async def test_where_there_is_none_the_network_is_thought_of(asked: list[str]) -> None:
    with pytest.raises(PortNotFoundError, match="tcp://"):
        await find_laser([HOKUYO.device, PROLIFIC.device])
    assert asked == [FTDI.path]
