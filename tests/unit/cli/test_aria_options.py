"""Options with one dash, as ARIA and MobileSim have them, become ours or say what does."""

import pytest

from pioneer3.cli.aria_options import in_our_words
from pioneer3.errors import ConfigError


def ours(line: str) -> tuple[str, list[str]]:
    told: list[str] = []
    return " ".join(in_our_words(line.split(), told.append)), told


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("drive -rh 10.0.0.2", "drive --port tcp://10.0.0.2:8101"),
        ("drive -remoteHost lab -rrtp 8102", "drive --port tcp://lab:8102"),
        ("wander -remoteRobotTcpPort 8102", "wander --port tcp://localhost:8102"),
        ("drive -rp /dev/ttyUSB1 -rb 38400", "drive --port /dev/ttyUSB1 --baud 38400"),
        ("drive -robotPort COM3 -ROBOTBAUD 9600", "drive --port COM3 --baud 9600"),
        ("demo -lt lms2xx -lp /dev/ttyUSB2", "demo --laser lms-200@/dev/ttyUSB2"),
        ("demo -laserPort /dev/ttyACM0", "demo --laser /dev/ttyACM0"),
        ("sim -map office.map -r p3dx -nomap", "sim --map office.map -r p3dx --nomap"),
        ("sim -m office.map -robot p2at", "sim -m office.map --robot p2at"),
        ("move -0.5 --speed -30cm -p COM3", "move -0.5 --speed -30cm -p COM3"),
        ("goto -1 -2", "goto -1 -2"),
        ("sim -mlab -vm lab", "sim -mlab -vm lab"),
        ("drive --remoteHost lab --robotBaud 9600", "drive --port tcp://lab:8101 --baud 9600"),
        ("drive -rh lab:8102", "drive --port tcp://lab:8102"),
        ("drive -rh tcp://lab/ -rrtp 8103", "drive --port tcp://lab:8103"),
        ("drive -rh ::1", "drive --port tcp://[::1]:8101"),
        (
            "demo -laserType2 urg -lp2 /dev/ttyACM0 -lt1 lms2xx -laserPort /dev/ttyUSB2",
            "demo --laser lms-200@/dev/ttyUSB2 --laser urg-04lx@/dev/ttyACM0",
        ),
        (
            "sim -log-file x -no-gui -bind-to-address ::",
            "sim --log-file x --bind-to-address ::",
        ),
        ("robot show -rb", "robot show -rb"),
        ("robot edit -laserFlipped", "robot edit -laserFlipped"),
        ("drive -rh h -- -rp x", "drive --port tcp://h:8101 -- -rp x"),
    ],
)
def test_an_option_becomes_ours(line: str, expected: str) -> None:
    assert ours(line) == (expected, [])


def test_an_option_without_effect_is_told_and_left_out() -> None:
    line, told = ours("wander -connectLaser -rlps")
    assert line == "wander"
    assert [each.partition(" has no effect: ")[0] for each in told] == ["-connectLaser", "-rlps"]


def test_a_value_of_an_option_without_effect_is_left_out_with_it() -> None:
    line, told = ours("wander -laserIncrement2 half -lsb 38400 -rp COM3 -rh lab")
    assert line == "wander --port tcp://lab:8101"
    options = [each.partition(" has no effect: ")[0] for each in told]
    assert options == ["-laserIncrement2", "-lsb", "-robotPort"]


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("drive -rh", "-rh: its value is missing"),
        ("drive -rh -rp COM3", "-rh: its value is missing"),
        ("drive -laserFlipped true", "-laserFlipped is ARIA's: give --laser-pose"),
        ("drive -ld 180", "-ld is ARIA's: give --laser-mask"),
        ("drive -lt sonar9000 -lp COM4", "-laserType sonar9000: known are lms2xx"),
        ("drive -rh lab --port COM3", "--port and ARIA's option for the robot's port: give one"),
        ("drive -rp COM3 -p=COM4", "-p=COM4 and ARIA's option for the robot's port: give one"),
        ("drive -lair 3,4", "-lair is ARIA's: give --laser-mask"),
        ("drive -compassPort COM3", "-compassPort is ARIA's: programs use robot.devices"),
        ("drive -lsb -rp COM3", "-lsb: its value is missing"),
        ("drive -lt urg", "-laserType: give the laser's port"),
    ],
)
def test_an_option_that_has_another_form_says_which(line: str, complaint: str) -> None:
    with pytest.raises(ConfigError, match=complaint):
        ours(line)
