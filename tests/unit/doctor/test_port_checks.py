"""Findings about the way to the robot: facts in, findings out."""

import pytest

from pioneer3.doctor.diagnose import diagnose, exit_code
from pioneer3.doctor.facts import Finding, Level, LinkFacts
from pioneer3.doctor.ports import PortHolder, SerialPort
from pioneer3.doctor.recognition import DeviceKind, OtherDevice
from pioneer3.errors import (
    LinkError,
    PortBusyError,
    PortNotFoundError,
    PortPermissionError,
    UnknownHostError,
)
from pioneer3.models import load_model
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Identity

URL = "/dev/ttyUSB0"
PORT = SerialPort(path=URL, device=URL)
FTDI = SerialPort(path=URL, device=URL, vendor_id=0x0403, product_id=0x6001, latency_ms=16)
MODEL = load_model("p3at-sh")
INFO = RobotInfo(
    identity=Identity(name="Bender", family="Pioneer", model="p3at-sh"),
    model=MODEL,
    limits=limits_for(MODEL, None),
    config=None,
    url=URL,
    speed=9600,
)


def only(facts: LinkFacts) -> Finding:
    """Return the one finding there is."""
    (finding,) = diagnose(facts)
    return finding


def the(check: str, facts: LinkFacts) -> Finding:
    """Return the finding of `check`; a page treats it unless all is well."""
    found = next(finding for finding in diagnose(facts) if finding.check == check)
    assert (found.symptom is None) is (found.level is Level.OK)
    return found


def test_a_port_that_is_not_there_leads_to_find_port() -> None:
    finding = only(LinkFacts(url=URL, port=PORT, refused=PortNotFoundError(f"{URL}: no such port")))
    assert (finding.level, finding.code) == (Level.FAIL, 3)
    assert "does not exist" in finding.found
    assert "p3 find-port" in finding.advice


def test_missing_permission_gives_the_command_and_the_code_4() -> None:
    finding = only(LinkFacts(url=URL, port=PORT, refused=PortPermissionError("denied")))
    assert (finding.level, finding.code) == (Level.FAIL, 4)
    assert "sudo usermod -aG dialout $USER" in finding.advice
    assert "log out and in again" in finding.advice


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("ModemManager", "systemctl disable --now ModemManager"),
        ("agetty", "serial-getty@ttyUSB0"),
        ("minicom", "kill 4711"),
    ],
)
def test_who_is_in_the_way_is_named_with_the_way_to_end_it(name: str, advice: str) -> None:
    port = SerialPort(path=URL, device=URL, holders=(PortHolder(4711, name),))
    finding = only(LinkFacts(url=URL, port=port))
    assert (finding.level, finding.code) == (Level.FAIL, 1)
    assert f"{name} (process 4711)" in finding.found
    assert advice in finding.advice


def test_a_getty_is_named_by_the_device_behind_a_stable_name() -> None:
    port = SerialPort(path="/dev/robot", device="/dev/ttyS0", holders=(PortHolder(1, "agetty"),))
    assert only(LinkFacts(url=URL, port=port)).advice.endswith("serial-getty@ttyS0")


def test_a_busy_port_whose_holder_is_hidden_says_how_to_find_it() -> None:
    finding = only(LinkFacts(url=URL, port=PORT, refused=PortBusyError("busy")))
    assert "another program" in finding.found
    assert finding.advice == f"Find it with: sudo fuser -v {URL}"


def test_any_other_refusal_is_quoted() -> None:
    finding = only(LinkFacts(url=URL, port=PORT, refused=LinkError(f"{URL}: not a serial port")))
    assert finding.code == 3
    assert "not a serial port" in finding.found


@pytest.mark.parametrize(
    ("error", "advice"),
    [
        (UnknownHostError("tcp://r:8101: no host of the name 'r' is known"), "spelling"),
        (PortNotFoundError("tcp://r:8101: nobody listens there"), "p3 sim"),
        (LinkError("tcp://r:8101: no answer within 5 s"), "ping"),
    ],
)
def test_network_refusals_are_told_apart(error: LinkError, advice: str) -> None:
    finding = only(LinkFacts(url="tcp://r:8101", refused=error))
    assert (finding.level, finding.code) == (Level.FAIL, 3)
    assert not finding.found.startswith("tcp://r:8101: ")
    assert advice in finding.advice


def test_a_slow_latency_timer_comes_with_the_command_that_sets_it() -> None:
    finding = the("adapter", LinkFacts(url=URL, port=FTDI, info=INFO))
    assert finding.level is Level.WARN
    assert "FTDI FT232R" in finding.found
    assert "16 ms" in finding.found
    command = "echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer"
    assert finding.advice.endswith(command)


def test_an_adapter_without_a_timer_is_fine_and_a_plain_port_has_none() -> None:
    quick = SerialPort(path=URL, device=URL, vendor_id=0x0403, product_id=0x6001, latency_ms=1)
    assert the("adapter", LinkFacts(url=URL, port=quick, info=INFO)).level is Level.OK
    assert "adapter" not in {f.check for f in diagnose(LinkFacts(url=URL, port=PORT, info=INFO))}


def test_the_console_of_this_computer_is_pointed_out() -> None:
    port = SerialPort(path=URL, device=URL, console=True)
    assert the("port", LinkFacts(url=URL, port=port, info=INFO)).level is Level.WARN


def test_a_robot_is_told_apart_from_a_simulator_in_capitals() -> None:
    assert the("answer", LinkFacts(url=URL, port=PORT, info=INFO)).found.startswith("ROBOT Bender")


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        (DeviceKind.LASER, "a laser: Hokuyo"),
        (DeviceKind.ECHO, "our own bytes"),
        (DeviceKind.TEXT, "Hokuyo"),
        (DeviceKind.NOISE, "make no sense"),
    ],
)
def test_a_stranger_is_introduced_and_is_not_reachable_as_a_robot(
    kind: DeviceKind, words: str
) -> None:
    facts = LinkFacts(
        url=URL, port=PORT, other_device=OtherDevice(kind, "Hokuyo"), heard_at=(19200,)
    )
    finding = the("answer", facts)
    assert words in finding.found
    assert "19200 baud" in finding.found
    assert finding.advice
    assert exit_code(diagnose(facts)) == 3


def test_silence_on_a_cable_lists_what_to_look_at_and_on_a_network_something_else() -> None:
    serial = the("answer", LinkFacts(url=URL, port=PORT))
    network = the("answer", LinkFacts(url="tcp://r:8101"))
    assert "9600, 19200, 38400, 57600, 115200 baud" in serial.found
    assert "HOST" in serial.advice
    assert "8101" in network.advice
    assert serial.code == network.code == 3


def test_a_hang_up_means_another_host_on_a_network_and_a_pulled_plug_on_a_cable() -> None:
    assert "another program" in the("answer", LinkFacts(url="tcp://r:8101", closed=True)).meaning
    assert "unplugged" in the("answer", LinkFacts(url=URL, port=PORT, closed=True)).meaning


def test_warnings_alone_end_with_0_and_the_first_failure_decides() -> None:
    warn = Finding(check="a", level=Level.WARN, found="")
    fails = [Finding(check="b", level=Level.FAIL, found="", code=code) for code in (4, 1)]
    assert exit_code([warn]) == 0
    assert exit_code([warn, *fails]) == 4
