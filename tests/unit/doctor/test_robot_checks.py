"""Findings about a robot that answers: facts in, findings out."""

from dataclasses import replace

import pytest
from msgspec import structs

from pioneer3.arcos.reports import Config
from pioneer3.doctor.diagnose import diagnose, exit_code
from pioneer3.doctor.facts import Finding, Heard, Level, LinkFacts
from pioneer3.doctor.ports import SerialPort
from pioneer3.geometry import ORIGIN, STILL
from pioneer3.models import load_model
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Battery, Identity, Motors, Odometry, Snapshot

URL = "/dev/ttyUSB0"
MODEL = load_model("p3at-sh")
CONFIG = Config(
    family="Pioneer",
    model="p3at-sh",
    serial_number="42",
    sip_cycle_ms=100,
    low_battery_decivolts=115,
    shutdown_decivolts=110,
)
INFO = RobotInfo(
    identity=Identity(name="Bender", family="Pioneer", model="p3at-sh"),
    model=MODEL,
    limits=limits_for(MODEL, CONFIG),
    config=CONFIG,
    url=URL,
    speed=9600,
)
SNAPSHOT = Snapshot(
    stamp=0.0,
    sequence=1,
    odometry=Odometry(robot_in_odom=ORIGIN, twist=STILL, left_speed=0.0, right_speed=0.0),
    battery=Battery(voltage=12.8),
    motors=Motors(),
)
HEARD = Heard(
    seconds=3.0,
    reports=30,
    longest_gap=0.11,
    packets=31,
    sonars=frozenset(range(16)),
    snapshot=SNAPSHOT,
)
FACTS = LinkFacts(url=URL, port=SerialPort(path=URL, device=URL), info=INFO, heard=HEARD)


def the(check: str, facts: LinkFacts) -> Finding:
    """Return the finding of `check`; a page treats it unless all is well."""
    found = next(finding for finding in diagnose(facts) if finding.check == check)
    assert (found.symptom is None) is (found.level is Level.OK)
    return found


def with_snapshot(**changes: object) -> LinkFacts:
    """Return facts of a robot whose last reading is different."""
    return replace(FACTS, heard=replace(HEARD, snapshot=replace(SNAPSHOT, **changes)))  # type: ignore[arg-type]


def test_a_healthy_robot_passes_every_check_from_the_plug_to_the_wheels() -> None:
    findings = diagnose(FACTS)
    assert {finding.level for finding in findings} == {Level.OK}
    assert [finding.check for finding in findings] == [
        "port",
        "answer",
        "speed",
        "session",
        "type",
        "config",
        "reports",
        "checksums",
        "stop button",
        "motors",
        "battery",
        "sonar",
    ]
    assert exit_code(findings) == 0


def test_another_speed_than_the_first_is_a_warning() -> None:
    finding = the("speed", replace(FACTS, info=replace(INFO, speed=38400)))
    assert finding.level is Level.WARN
    assert "38400 baud; robots start at 9600" in finding.found


def test_a_link_without_speed_has_no_wrong_one() -> None:
    facts = replace(FACTS, info=replace(INFO, speed=None))
    assert "speed" not in {finding.check for finding in diagnose(facts)}


def test_a_session_left_open_is_a_warning() -> None:
    finding = the("session", replace(FACTS, streaming=True))
    assert finding.level is Level.WARN
    assert "earlier session" in finding.found


def test_no_configuration_and_one_with_a_wrong_checksum_are_warnings() -> None:
    missing = the("config", replace(FACTS, info=replace(INFO, config=None)))
    doubtful = the("config", replace(FACTS, heard=replace(HEARD, config_trusted=False)))
    assert missing.level is doubtful.level is Level.WARN
    assert "Pioneer 3-AT" in missing.meaning
    assert "P3-DX-SH" in doubtful.meaning


@pytest.mark.parametrize(
    ("reports", "cycle_ms", "level"),
    [
        (30, 100, Level.OK),
        (26, 100, Level.OK),
        (25, 100, Level.WARN),
        (14, 100, Level.FAIL),
        (0, 100, Level.FAIL),
        (30, 50, Level.WARN),
        (15, 200, Level.OK),
        (30, 0, Level.OK),
    ],
)
def test_the_rate_is_measured_against_the_cycle_in_the_configuration(
    reports: int, cycle_ms: int, level: Level
) -> None:
    config = structs.replace(CONFIG, sip_cycle_ms=cycle_ms)
    facts = replace(FACTS, info=replace(INFO, config=config), heard=replace(HEARD, reports=reports))
    assert the("reports", facts).level is level


def test_a_session_that_breaks_off_is_a_failure() -> None:
    finding = the("reports", replace(FACTS, heard=replace(HEARD, ended="it hung up")))
    assert (finding.level, finding.code) == (Level.FAIL, 1)
    assert "it hung up" in finding.found


@pytest.mark.parametrize(
    ("bad", "skipped", "level"),
    [(0, 0, Level.OK), (0, 3, Level.WARN), (1, 40, Level.WARN), (3, 120, Level.FAIL)],
)
def test_spoilt_frames_are_weighed(bad: int, skipped: int, level: Level) -> None:
    heard = replace(HEARD, bad_checksums=bad, bytes_skipped=skipped)
    assert the("checksums", replace(FACTS, heard=heard)).level is level


def test_with_a_usb_adapter_the_adapter_is_suspected_first() -> None:
    port = SerialPort(path=URL, device=URL, vendor_id=0x067B, product_id=0x2303)
    heard = replace(HEARD, bad_checksums=5)
    assert "Prolific PL2303" in the("checksums", replace(FACTS, port=port, heard=heard)).advice
    assert "shielded" in the("checksums", replace(FACTS, heard=heard)).advice
    assert "far end" in the("checksums", replace(FACTS, port=None, heard=heard)).advice


def test_a_pressed_stop_button_is_a_failure_of_code_1() -> None:
    finding = the("stop button", with_snapshot(motors=Motors(stop_button=True)))
    assert (finding.level, finding.code) == (Level.FAIL, 1)


def test_motors_that_stay_on_are_a_warning() -> None:
    assert the("motors", with_snapshot(motors=Motors(enabled=True))).level is Level.WARN


def test_a_stall_names_its_side() -> None:
    finding = the("stall", with_snapshot(motors=Motors(left_stalled=True)))
    assert finding.level is Level.WARN
    assert finding.found == "left wheels blocked"


@pytest.mark.parametrize(
    ("battery", "level"),
    [
        (Battery(voltage=12.8), Level.OK),
        (Battery(voltage=11.3, low=True), Level.WARN),
        (Battery(voltage=10.9, low=True), Level.FAIL),
        (Battery(voltage=0.0), Level.OK),
    ],
)
def test_the_battery_is_measured_against_the_robots_own_levels(
    battery: Battery, level: Level
) -> None:
    assert the("battery", with_snapshot(battery=battery)).level is level


def test_missing_sonars_are_named() -> None:
    heard = replace(HEARD, sonars=frozenset(range(8)))
    finding = the("sonar", replace(FACTS, heard=heard))
    assert finding.level is Level.WARN
    assert "8 of 16" in finding.found
    assert "8, 9, 10, 11, 12, 13, 14, 15" in finding.found


def test_faults_are_listed() -> None:
    finding = the("faults", with_snapshot(faults=("gyro fault", "undervoltage")))
    assert finding.level is Level.WARN
    assert finding.found == "gyro fault, undervoltage"


def test_without_a_single_report_the_state_is_left_out() -> None:
    facts = replace(FACTS, heard=replace(HEARD, reports=0, snapshot=None))
    assert the("reports", facts).level is Level.FAIL
    assert "battery" not in {finding.check for finding in diagnose(facts)}
