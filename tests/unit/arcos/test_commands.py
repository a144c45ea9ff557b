"""What commands accept, refuse and tolerate."""

from math import inf, nan, radians

import pytest

from pioneer3.arcos import commands as c
from pioneer3.errors import CommandError


def test_every_number_has_one_meaning_to_a_robot() -> None:
    old = {cls for cls in c.every_command() if c.is_old(cls)}
    robot = [cls.ID for cls in c.every_command() if cls not in old]
    assert len(robot) == len(set(robot))
    assert {cls.ID for cls in old} == {*range(35, 39), 59, *range(61, 65), *range(66, 70)}


def test_every_class_says_its_number() -> None:
    for cls in c.every_command():
        assert f"ARCOS {cls.ID}" in (cls.__doc__ or ""), cls


def test_every_name_is_exported() -> None:
    names = {cls.__name__ for cls in c.every_command()}
    assert names <= set(c.__all__) | set(c.NUMBERS)
    assert len(c.__all__) == len(set(c.__all__))
    assert all(hasattr(c, name) for name in c.__all__)
    assert not hasattr(c, "Warp")


def test_the_table_has_what_has_no_class() -> None:
    assert c.named("ARM_POS", 2, 90) == c.from_payload(bytes.fromhex("4d 3b 5a 02"))
    assert repr(c.named("ARM_POS", 2, 90)) == "ARM_POS(joint=2, position_raw=90)"
    assert c.named("ROTKP", 40).ID == c.NUMBERS["ROTKP"] == 82
    assert not set(c.NUMBERS) & set(c.__all__)


@pytest.mark.parametrize("value", [nan, inf, -inf, 32.768, -32.769, 1e308, True, "1", None])
def test_a_speed_that_does_not_fit_is_refused_by_name(value: float) -> None:
    with pytest.raises(CommandError, match=r"^Vel\.speed: "):
        c.to_payload(c.Vel(value))


@pytest.mark.parametrize(
    ("command", "says"),
    [
        (c.Vel(99.0), "Vel.speed: 99.0 is outside -32.768..32.767"),
        (c.SetV(-0.1), "SetV.speed: -0.1 is outside 0..32.767"),
        (c.Vel2(128, 0), "Vel2.left_units: 128 is outside -128..127"),
        (c.named("ROTKP", 2**16), "ROTKP.gain: 65536 is outside 0..65535"),
        (c.named("ROTKP", True), "ROTKP.gain: True is not an integer"),
        (c.Enable(on=1), "Enable.on: 1 is neither True nor False"),  # type: ignore[arg-type]
        (c.JoyInfo(3), "JoyInfo.how: 3 is not one of 0 STOP, 1 ONCE, 2 STREAM"),  # type: ignore[arg-type]
        (c.Say((c.Tone(9.0, 1),)), "Say.tones: Tone.duration: 9.0 is outside 0..5.1"),
        (c.Say((c.Tone(1.0, 1),) * 21), "Say.tones: 42 bytes are more than 40"),
        (c.Tty2(bytes(200)), "Tty2.data: 200 bytes are more than 199"),
        (c.Tty2("x"), "Tty2.data: 'x' is not bytes"),  # type: ignore[arg-type]
        (c.SimMessage("\u20ac"), "SimMessage.text: '\u20ac' is not a latin-1 text"),
        (c.SetO(y=1.0), "SetO.y: 1.0 cannot follow x, which is missing"),
    ],
)
def test_a_misfit_names_class_field_value_and_range(command: c.Command, says: str) -> None:
    with pytest.raises(CommandError) as caught:
        c.to_payload(command)
    assert str(caught.value) == says


@pytest.mark.parametrize(
    ("payload", "command"),
    [
        ("02", c.Close()),
        ("12", c.RequestConfig()),
        ("12 3b", c.RequestConfig()),
        ("00 3b 64 00", c.Pulse()),  # ARIA's SETLATV
        ("07 3b e8 03 d0 07 5a 00", c.SetO(x=1.0, y=2.0, heading=radians(90))),
        ("0b 3b c8 00 ff ff", c.Vel(0.2)),
        ("0b 1b 00 80", c.Vel(-32.768)),
        ("0b 3b 38 ff", c.Vel(-0.2)),
        ("58 1b c0 63", c.RevCount(40000)),
        ("1c 3b 05 00", c.Sonar(on=True, array=2)),
        ("04 3b 02 00", c.Enable(on=True)),
        ("ed", c.RequestSimStat(c.RequestMode.ONCE)),
        ("e0 3b 00 00 00 00 00 00 00 00 00 00 00 00", c.SimSetPose(0.0, 0.0, 0.0)),
        ("2a 2b", c.Tty2(b"")),
        ("2a 2b 02 41 42 43", c.Tty2(b"\x02ABC")),
        ("e9 3b 01 00", c.SimLrfSetRes(radians(1))),
        ("e9 3b 32 00", c.SimLrfSetRes(radians(0.5))),
    ],
)
def test_what_the_standard_leaves_open_is_tolerated(payload: str, command: c.Command) -> None:
    assert c.from_payload(bytes.fromhex(payload)) == command


@pytest.mark.parametrize(
    "payload",
    [
        "",
        "c8",
        "0b",  # no speed
        "0b 3b",
        "0b 3b c8",
        "0b 00 c8 00",  # no such type
        "06 1b 05 00",  # a negative limit
        "25 3b 5a 00",  # a laser's end angle, which is no gripper request
        "0f 2b 03 0a 64 14",  # half a tone
        "2a 3b 01 00",  # no string
        "3b 2b 01 41",  # only old simulators know it
    ],
)
def test_what_makes_no_sense_is_unknown_and_keeps_its_bytes(payload: str) -> None:
    command = c.from_payload(bytes.fromhex(payload))
    assert isinstance(command, c.Unknown)
    assert c.to_payload(command).hex(" ") == payload


@pytest.mark.parametrize(
    ("payload", "to_robot", "to_simulator"),
    [
        ("23 3b 02 00", c.AdSel(2), c.OldLaser(c.SimLaserMode.EXTENDED)),
        ("25 3b 02 00", c.GripperPacRequest(c.RequestMode.STREAM), c.OldLaserEnd(radians(2))),
        ("3e 3b 01 00", c.RequestBatteryInfo(c.RequestMode.ONCE), c.named("END_SIM")),
        ("43 3b 05 00", c.GetAux2(5), c.named("SET_TRUE_Y", 0.005)),
        ("e1", c.SimReset(), c.SimReset()),
    ],
)
def test_colliding_numbers_depend_on_who_listens(
    payload: str, to_robot: c.Command, to_simulator: c.Command
) -> None:
    assert c.from_payload(bytes.fromhex(payload)) == to_robot
    assert c.from_payload(bytes.fromhex(payload), simulator=True) == to_simulator


def test_a_string_too_long_to_be_written_is_unknown() -> None:
    payload = b"\x2a\x2b" + bytes([0xFF]) * 200
    assert c.from_payload(payload) == c.Unknown(0x2A, payload[1:])


def test_values_round_once_to_the_nearest_unit() -> None:
    assert c.to_payload(c.Vel(0.0126)).hex(" ") == "0b 3b 0d 00"
    assert c.to_payload(c.RVel(radians(-29.6))).hex(" ") == "15 1b 1e 00"


def test_missing_optional_arguments_are_not_written() -> None:
    assert c.to_payload(c.SimLrfEnable(c.SimLaserMode.OFF)).hex(" ") == "e6 3b 00 00"
    assert c.to_payload(c.SimCtrl(c.SimOperation.REQUEST_INFO)).hex(" ") == "ec 3b 06 00"
