"""ARIA parameter files: read like the shipped models; what is wrong is named by line and key."""

from dataclasses import replace
from math import degrees, pi, radians
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.models import IrMount, LaserMount, RobotModel, load_model
from pioneer3.models.aria import parse_aria

COMMON = ("amigo-sh", "p3at", "p3at-sh", "p3dx", "p3dx-sh", "peoplebot-sh")
MINIMAL = """\
Subclass lab
RobotRadius 250
RobotWidth 425
RobotLength 500
MaxVelocity 2200
MaxRVelocity 500
AngleConvFactor 0.00153
DistConvFactor 1.0
DiffConvFactor 0.0056
"""


def read(text: str) -> RobotModel:
    return parse_aria(text, "my.p", "my")


def as_aria(model: RobotModel) -> str:
    """Write `model` the way ARIA would: mm, degrees, factors rounded to five digits."""
    sonars = (
        f"SonarUnit {n} {s.x * 1000:.0f} {s.y * 1000:.0f} {degrees(s.theta):.0f}"
        for n, s in enumerate(model.sonars)
    )
    irs = (f"IRUnit {n} 1 2 {x * 1000:g} {y * 1000:g}" for n, (x, y) in enumerate(model.table_irs))
    laser = model.laser or LaserMount(kind='""', x=0, y=0, theta=0)
    return f"""\
; a robot of the lab
Section General settings
Class {model.family}          ; kind of robot
Subclass {model.name}
RobotRadius {model.radius * 1000:.5f}   ; mm
RobotWidth {model.width * 1000:.5f}
RobotLength {model.length * 1000:.5f}
RobotLengthFront {model.length_front * 1000:.5f} ; a comment that goes on
                               ; in the next line
RobotLengthRear {model.length_rear * 1000:.5f}
MaxVelocity {model.max_speed * 1000:.0f}
MaxRVelocity {degrees(model.max_turn_rate):.0f}
RequestIOPackets {str(model.request_io).lower()}

Section Conversion factors
AngleConvFactor 0.00153
DistConvFactor {model.distance_factor * 1000:.5f}
DiffConvFactor {0.002 / model.wheel_base:.5f}
Section Accessories the robot has
TableSensingIR {str(bool(model.table_irs)).lower()}
FrontBumpers {str(model.front_bumpers > 0).lower()}
NumFrontBumpers 5
RearBumpers {str(model.rear_bumpers > 0).lower()}
NumRearBumpers 5
Section IR parameters
;  IRUnit <number> <type> <cycles> <x position, mm> <y
 position, mm>
{chr(10).join(irs)}
Section Movement control parameters
TransVelMax 0
RotAccel 0
Section Sonar parameters
SonarNum {len(model.sonars)}
{chr(10).join(sonars)}
Section Laser parameters
LaserAutoConnect true
LaserType {laser.kind}
LaserX {laser.x * 1000:.0f}
LaserY 0
LaserTh 0.00000
LaserIgnore -135--120 120-135
Section Laser 2 parameters
LaserAutoConnect true
LaserX 999
LaserType            ; none
"""


@pytest.mark.parametrize("name", COMMON)
def test_the_same_numbers_give_the_shipped_model(name: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.p"
    path.write_text(as_aria(load_model(name)))
    assert load_model(path) == load_model(name)


@pytest.mark.parametrize("name", COMMON)
def test_line_ends_byte_order_mark_and_case_do_not_matter(name: str, tmp_path: Path) -> None:
    path = tmp_path / "ROBOT.P"
    text = as_aria(load_model(name)).replace("\n", "\r\n")
    path.write_bytes(b"\xef\xbb\xbf" + text.swapcase().encode() + b"; \xe9 in Latin-1\r\n")
    loaded = load_model(path)
    assert replace(loaded, laser=None, family="Pioneer") == replace(load_model(name), laser=None)


def test_the_essential_keys_are_enough() -> None:
    model = read(MINIMAL)
    assert (model.name, model.title, model.family) == ("lab", "lab", "Pioneer")
    assert (model.length_front, model.length_rear) == (0.25, 0.25)
    assert (model.speed_factor, model.range_factor, model.vel2_unit) == (0.001, 0.001, 0.02)
    assert (model.sonars, model.table_irs, model.laser) == ((), (), None)
    assert (model.acceleration, model.turn_deceleration) == (0.3, radians(100))


def test_without_a_subclass_the_file_gives_its_name(tmp_path: Path) -> None:
    path = tmp_path / "Robi.p"
    path.write_text(MINIMAL.replace("Subclass lab", "Subclass"))
    assert load_model(path).name == "robi"


@pytest.mark.parametrize(
    ("factor", "exact"),
    [
        ("0.00153", 2 * pi / 4096),
        ("0.001534", 2 * pi / 4096),
        ("0.00614", 2 * pi / 1024),
        ("0.003", 0.003),
    ],
)
def test_rounded_heading_factors_are_made_exact(factor: str, exact: float) -> None:
    assert read(MINIMAL.replace("0.00153", factor)).heading_factor == exact


def test_a_pioneer_1_has_its_own_units() -> None:
    model = read(
        MINIMAL + "VelConvFactor 2.5332\nRangeConvFactor 0.1734\nVel2Divisor 4\n"
        "DistConvFactor 0.05066\nSwitchToBaudRate 0\nHasMoveCommand false\n"
        "SettableAccsDecs false\nSettableVelMaxes false\nRequestEncoderPackets true\n"
    )
    assert model.distance_factor == 0.00005066
    assert (model.speed_factor, model.range_factor) == (0.0025332, 0.0001734)
    assert (model.vel2_unit, model.switch_speed) == (0.004, 0)
    assert not model.has_move_command
    assert not model.settable_acceleration
    assert not model.settable_speed
    assert model.request_encoders


def test_a_lower_speed_limit_of_the_owner_is_kept() -> None:
    model = read(MINIMAL + "TransVelMax 400\nRotVelMax 90\n")
    assert (model.max_speed, model.max_turn_rate) == (0.4, radians(90))


def test_a_higher_one_does_not_lift_the_absolute_maximum() -> None:
    assert read(MINIMAL + "TransVelMax 9000\n").max_speed == 2.2


def test_accelerations_of_the_owner_are_kept() -> None:
    model = read(MINIMAL + "TransAccel 500\nTransDecel 600\nRotAccel 150\nRotDecel 200\n")
    assert (model.acceleration, model.deceleration) == (0.5, 0.6)
    assert (model.turn_acceleration, model.turn_deceleration) == (radians(150), radians(200))


def test_quotes_blank_values_repeats_and_unknown_keys_are_taken_in_stride() -> None:
    model = read(
        MINIMAL + '"RobotRadius" "300"\nSubclass "P3AT; odd"\nCompassPort\nTransAccel ""\n'
        '"" 5\nGPSPX here\nSection\n"unclosed\nRobotWidth 400;mm\n'
    )
    assert (model.radius, model.width, model.name) == (0.3, 0.4, "p3at; odd")
    assert (model.title, model.drive, model.acceleration) == ("Pioneer 3-AT", "skid", 0.3)


def test_bumpers_count_only_where_the_flag_says_so() -> None:
    model = read(
        MINIMAL + "FrontBumpers true\nNumFrontBumpers 7\nRearBumpers false\nNumRearBumpers 5\n"
    )
    assert (model.front_bumpers, model.rear_bumpers) == (7, 0)


def test_sonars_come_in_any_order_and_with_further_columns() -> None:
    model = read(
        MINIMAL + "SonarUnit 2 -100 50 -180 1 3 0 500 500 1\nSonarUnit 0 1 2 3\n"
        "SonarUnit 1 10.5 20 30\nSonarUnit 0 4 5 6\n"
    )
    assert [(s.x, s.y) for s in model.sonars] == [(0.004, 0.005), (0.0105, 0.02), (-0.1, 0.05)]
    assert [s.theta for s in model.sonars] == [radians(6), radians(30), pi]


@pytest.mark.parametrize(("declared", "kept"), [(0, 0), (1, 1), (2, 2), (32, 2)])
def test_sonar_num_leaves_units_out_but_invents_none(declared: int, kept: int) -> None:
    text = f"SonarNum {declared}\nSonarUnit 0 1 2 3\nSonarUnit 1 4 5 6\n"
    assert len(read(MINIMAL + text).sonars) == kept


def test_table_sensors_count_only_on_a_robot_that_has_them() -> None:
    units = "IRUnit 1 1 2 333 233\nIRUnit 0 1 2 333 -233\n"
    assert read(MINIMAL + units).table_irs == ()
    model = read(MINIMAL + "TableSensingIR true\n" + units)
    assert model.table_irs == (IrMount(0.333, -0.233), IrMount(0.333, 0.233))


def test_the_first_laser_that_exists_is_taken() -> None:
    first = "Section Laser parameters\nLaserType lms2xx\nLaserX 125\nLaserAutoConnect false\n"
    second = "Section Laser 2 parameters\nLaserType urg2.0\nLaserX 160\nLaserY -7\nLaserTh 270\n"
    expected = LaserMount(kind="urg2.0", x=0.16, y=-0.007, theta=-pi / 2)
    assert read(MINIMAL + first + second).laser == expected
    assert read(MINIMAL + first).laser is None


@pytest.mark.parametrize(
    "key",
    [
        "RobotRadius",
        "RobotWidth",
        "RobotLength",
        "MaxVelocity",
        "MaxRVelocity",
        "AngleConvFactor",
        "DistConvFactor",
        "DiffConvFactor",
    ],
)
def test_a_missing_essential_key_is_named(key: str) -> None:
    lines = [line for line in MINIMAL.splitlines() if not line.startswith(f"{key} ")]
    with pytest.raises(ConfigError, match=rf"^my\.p: {key}: missing, expected [\d.e-]+ to "):
        read("\n".join(lines))
    with pytest.raises(ConfigError, match=rf"^my\.p:9: {key}: missing, expected "):
        read("\n".join([*lines, f"{key} ; forgotten"]))


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("RobotRadius big", "'big' is not a number"),
        ("RobotRadius 1_000", "'1_000' is not a number"),
        ("RobotRadius nan", "'nan' is not a number"),
        ("RobotRadius 1e999", "this number is out of range, expected 10 to 10000"),
        ("RobotRadius 0", "0 is out of range, expected 10 to 10000"),
        ("RobotRadius -250", "-250 is out of range, expected 10 to 10000"),
        ("RobotRadius 0.25", "0.25 is out of range, expected 10 to 10000"),
        ("RobotLength 10", "10 is out of range, expected 20 to 20000"),
        ("RobotLengthFront -1", "-1 is out of range, expected 10 to 10000"),
        ("MaxRVelocity 99999", "99999 is out of range, expected 0.572958 to 2864.79"),
        ("DiffConvFactor 5.6", "5.6 is out of range, expected 0.0002 to 0.2"),
        ("TransAccel fast", "'fast' is not a number"),
        ("HasMoveCommand maybe", "'maybe' is neither true nor false"),
        ("FrontBumpers 2", "'2' is neither true nor false"),
        ("NumRearBumpers 8", "8 is out of range, expected 0 to 7"),
        ("NumRearBumpers 1.5", "1.5 is not a whole number"),
        ("SwitchToBaudRate 38401", "38401 is not one of 0, 9600"),
        ("SonarNum -1", "-1 is out of range, expected 0 to 256"),
        ("SonarUnit", "too few values, expected x y th from value 2 on"),
        ("SonarUnit 0 1 2", "too few values, expected x y th from value 2 on"),
        ("SonarUnit 0 1 y 3", "'y' is not a number"),
        ("SonarUnit 0.5 1 2 3", "0.5 is not a whole number"),
        ("SonarUnit 256 1 2 3", "256 is out of range, expected 0 to 255"),
        ("SonarUnit 0 1 2 361", "361 is out of range, expected -360 to 360"),
        ("SonarUnit 0 1 20000 3", "20000 is out of range, expected -10000 to 10000"),
        ("IRUnit 0 1 2 3", "too few values, expected x y from value 4 on"),
        ("LaserX far", "'far' is not a number"),
        ("LaserType \x1b[31m", "'\\x1b[31m' is not printable"),
        ("Class \x07", "'\\x07' is not printable"),
        ("RobotWidth " + "x" * 5000, "'" + "x" * 40 + "' is not a number"),
    ],
)
def test_a_malformed_line_is_named(line: str, problem: str) -> None:
    with pytest.raises(ConfigError) as caught:
        read(f"{MINIMAL}\n{line}\n; end\n")
    assert str(caught.value).startswith(f"my.p:11: {line.split(maxsplit=1)[0]}: {problem}")
    assert str(caught.value).isprintable()


def test_a_gap_between_sonars_is_named() -> None:
    with pytest.raises(ConfigError, match=r"^my\.p: SonarUnit 1: missing, number the units from 0"):
        read(MINIMAL + "SonarUnit 0 1 2 3\nSonarUnit 2 4 5 6\n")


@given(st.text())
@example("\ufeff")
def test_any_text_gives_a_model_or_names_the_file(text: str) -> None:
    check(text)


KEYS = sorted({line.split()[0] for line in as_aria(load_model("peoplebot-sh")).split("\n") if line})
WORDS = st.one_of(
    st.sampled_from(["0", "1", "5", "38400", "true", "false", '"', ";", "-180", "1e400", "\x1b"]),
    st.floats().map(repr),
    st.integers(-10, 5000).map(repr),
    st.text(max_size=5),
)


@given(
    st.lists(
        st.tuples(st.sampled_from(KEYS), st.lists(WORDS, max_size=6)).map(
            lambda line: " ".join([line[0], *line[1]])
        ),
        max_size=30,
    )
)
def test_known_keys_with_any_values_give_a_model_or_name_the_file(lines: list[str]) -> None:
    check(MINIMAL + "\n".join(lines))


def check(text: str) -> None:
    result = outcome(text)
    if isinstance(result, str):
        assert result.startswith("my.p:")
        assert result.isprintable()


def outcome(text: str) -> RobotModel | str:
    try:
        return read(text)
    except ConfigError as error:
        return str(error)
