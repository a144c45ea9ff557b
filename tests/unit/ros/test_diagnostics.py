from dataclasses import replace
from typing import Any

import pytest

from pioneer3.arcos.reports import Config, Fault
from pioneer3.limits import Limits
from pioneer3.robot.explain import Reason, ReasonKind
from pioneer3.robot.supervisor import WATCHES, RobotInfo
from pioneer3.ros.messages.diagnostics import (
    DiagnosticLevel,
    DiagnosticStatus,
    DiagnosticsUpdate,
    Health,
    diagnose,
    diagnostics,
    hardware_id,
)
from pioneer3.state import Battery, Identity, LinkQuality, Motors, Sonar, Words
from tests.unit.ros.support import P3AT, Blank, seen

CONFIG = Config(
    family="Pioneer",
    model="p3at-sh",
    serial_number="1234",
    sip_cycle_ms=100,
    shutdown_decivolts=110,
)
INFO = RobotInfo(
    identity=Identity(name="bender", family="Pioneer", model="p3at-sh"),
    model=P3AT,
    limits=Limits(max_speed=0.7, max_turn_rate=1.5),
    config=CONFIG,
    url="/dev/ttyUSB0",
    speed=38400,
)
FINE = LinkQuality(reports=600, rate=10.0)


def told(health: Health) -> dict[str, DiagnosticStatus]:
    """Return the conditions by part."""
    return {each.part: each for each in diagnose(health)}


def of(**parts: Any) -> dict[str, DiagnosticStatus]:
    """Return the conditions of a robot that is fine but for `parts` of its snapshot."""
    return told(Health(info=INFO, snapshot=seen(**{"link": FINE, **parts})))


def test_a_robot_that_is_fine_is_fine_in_every_part() -> None:
    found = of(sonar=Sonar(ranges=(1.0,) * 16, enabled=True))
    assert tuple(found) == ("Link", "Motors", "Battery", "Sonar", "Odometry", "Command")
    assert {each.level for each in found.values()} == {DiagnosticLevel.OK}
    assert found["Sonar"].message == "16 of 16 transducers read"


def test_values_have_the_same_keys_whatever_happens() -> None:
    bad = of(
        motors=Motors(stop_button=True, left_stalled=True),
        battery=Battery(voltage=10.5, low=True),
        words=Words(faults=0xFFFF),
        link=LinkQuality(reports=100, rate=3.0, bad_checksums=50),
    )
    for part, condition in of().items():
        assert [key for key, _ in condition.values] == [key for key, _ in bad[part].values]


@pytest.mark.parametrize(
    ("motors", "level", "words"),
    [
        (Motors(enabled=True), DiagnosticLevel.OK, "on"),
        (Motors(), DiagnosticLevel.OK, "off"),
        (Motors(enabled=True, left_stalled=True), DiagnosticLevel.WARN, "left wheels are stalled"),
        (Motors(stop_button=True), DiagnosticLevel.ERROR, "stop button"),
    ],
)
def test_motors_tell_what_keeps_them(motors: Motors, level: DiagnosticLevel, words: str) -> None:
    condition = of(motors=motors)["Motors"]
    assert condition.level is level
    assert words in condition.message


def test_motors_that_no_command_switches_on_are_told_with_the_service_that_does() -> None:
    kept_off = Health(info=INFO, snapshot=seen(link=FINE, motors=Motors()), auto_enable=False)
    condition = told(kept_off)["Motors"]
    assert condition.level is DiagnosticLevel.WARN
    assert "enable_motors" in condition.message
    on = replace(kept_off, snapshot=seen(link=FINE, motors=Motors(enabled=True)))
    assert told(on)["Motors"].message == "on"


def test_the_latch_is_an_error() -> None:
    condition = told(Health(info=INFO, snapshot=seen(), emergency=True))["Motors"]
    assert condition.level is DiagnosticLevel.ERROR
    assert ("emergency_stop", "yes") in condition.values


@pytest.mark.parametrize(
    ("battery", "level"),
    [
        (Battery(voltage=12.5), DiagnosticLevel.OK),
        (Battery(voltage=11.4, low=True), DiagnosticLevel.WARN),
        (Battery(voltage=11.0, low=True), DiagnosticLevel.ERROR),
        (Battery(voltage=0.0), DiagnosticLevel.OK),
    ],
)
def test_a_battery_runs_low_and_then_out(battery: Battery, level: DiagnosticLevel) -> None:
    assert of(battery=battery)["Battery"].level is level


@pytest.mark.parametrize(
    ("link", "level"),
    [
        (FINE, DiagnosticLevel.OK),
        (replace(FINE, rate=8.0), DiagnosticLevel.WARN),
        (replace(FINE, reports=2, rate=0.0), DiagnosticLevel.OK),  # it has only begun
        (replace(FINE, bad_checksums=60), DiagnosticLevel.WARN),
    ],
)
def test_a_slow_or_noisy_link_is_a_warning(link: LinkQuality, level: DiagnosticLevel) -> None:
    assert of(link=link)["Link"].level is level


@pytest.mark.parametrize("fault", list(Fault))
def test_every_fault_flag_is_told_of_by_one_part(fault: Fault) -> None:
    found = of(words=Words(faults=int(fault)))
    words = str(fault.name).lower().replace("_", " ")
    guilty = [part for part, each in found.items() if words in each.message]
    assert len(guilty) == 1
    assert found[guilty[0]].level is not DiagnosticLevel.OK


def test_without_a_robot_everything_else_is_stale() -> None:
    found = told(Health(info=INFO, snapshot=None, lost="cable pulled"))
    assert found["Link"].level is DiagnosticLevel.ERROR
    assert "cable pulled" in found["Link"].message
    assert {each.level for part, each in found.items() if part != "Link"} == {DiagnosticLevel.STALE}


def test_why_it_does_not_move_is_told() -> None:
    why = Reason(ReasonKind.NORMAL, "The motors are off; they are being switched on.")
    found = told(Health(info=INFO, snapshot=seen(), why_not_moving=why))["Command"]
    assert (found.level, found.message) == (DiagnosticLevel.OK, why.text)
    why = Reason(ReasonKind.FAULT, "Waiting for a fresh command.")
    blocked = Health(info=INFO, snapshot=seen(), why_not_moving=why, refused="the wheels stalled")
    found = told(blocked)["Command"]
    assert (found.level, found.message) == (DiagnosticLevel.WARN, "the wheels stalled")
    assert ("why_not_moving", why.text) in found.values


def test_a_command_warns_by_the_kind_of_its_reason() -> None:
    def command(why: Reason | None, refused: str | None) -> tuple[DiagnosticLevel, str]:
        health = Health(info=INFO, snapshot=seen(), why_not_moving=why, refused=refused)
        found = told(health)["Command"]
        return found.level, found.message

    fault = Reason(ReasonKind.FAULT, "The wheels are stalled.")
    assert command(fault, None) == (DiagnosticLevel.WARN, fault.text)
    assert command(WATCHES, "the link was lost") == (DiagnosticLevel.OK, WATCHES.text)
    assert command(None, "a raw command drives") == (DiagnosticLevel.WARN, "a raw command drives")
    assert command(None, None) == (DiagnosticLevel.OK, "moving")


def test_a_message_has_a_status_of_each_part_with_the_nodes_name() -> None:
    message = Blank()
    diagnostics(
        message,
        DiagnosticsUpdate(
            found=diagnose(Health(info=INFO, snapshot=seen())),
            stamp="now",
            node="/lab/RosAria",
            hardware=hardware_id(INFO),
            make=lambda kind: Blank(kind=kind),
        ),
    )
    assert message.header.stamp == "now"
    first = message.status[0]
    assert (first.kind, first.name) == ("diagnostic_msgs/DiagnosticStatus", "lab/RosAria: Link")
    assert first.hardware_id == "bender 1234"
    assert first.values[0].key == "url"
    assert first.values[0].value == "/dev/ttyUSB0"
    assert {type(status.level) for status in message.status} == {int}


def test_a_robot_that_tells_no_serial_number_is_known_by_its_name() -> None:
    assert hardware_id(replace(INFO, config=None)) == "bender"
