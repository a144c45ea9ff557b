"""What page and server tell each other."""

import json
from math import inf, nan
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.arcos.reports import Config
from pioneer3.geometry import Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.models import load_model
from pioneer3.robot.explain import Reason, ReasonKind
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Battery, Bumpers, Identity, Motors, Odometry, Snapshot, Sonar
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.web import messages, requests
from pioneer3.web.robot_view import called, robot_part, snapshot_part
from tests.unit.web.browser import strict

MODEL = load_model("p3dx-sh")
LIMITS = Limits(max_speed=0.75, max_turn_rate=1.5)


def info(limits: Limits = LIMITS, name: str = "dora", serial: str = "4711") -> RobotInfo:
    return RobotInfo(
        identity=Identity(name=name, family="Pioneer", model="p3dx-sh"),
        model=MODEL,
        limits=limits,
        config=Config(family="Pioneer", model="p3dx-sh", serial_number=serial),
        url="serial:/dev/ttyUSB0",
        speed=9600,
    )


def reading(number: float = 0.0) -> Snapshot:
    return Snapshot(
        stamp=1.0,
        sequence=7,
        odometry=Odometry(
            robot_in_odom=Pose2(number, number, number),
            twist=Twist2(number, number),
            left_speed=number,
            right_speed=number,
        ),
        battery=Battery(voltage=number, charge=None),
        motors=Motors(enabled=True, left_stalled=True),
        sonar=Sonar(ranges=(1.5, inf, nan, number), enabled=True),
        bumpers=Bumpers(front=(True, False), rear=()),
        faults=("over_current",),
    )


def said(message: messages.Message | messages.Part) -> dict[str, Any]:
    """Return `message` as a browser gets it."""
    return strict(messages.encode(message))


def test_hello_shows_the_robot_as_the_model_has_it() -> None:
    robot = said(robot_part(1, "dora", info()))["shape"]
    assert robot == {
        "name": "dora",
        "model": "p3dx-sh",
        "title": MODEL.title,
        "length_front": MODEL.length_front,
        "length_rear": MODEL.length_rear,
        "width": MODEL.width,
        "sonars": [{"x": s.x, "y": s.y, "theta": s.theta} for s in MODEL.sonars],
        "front_bumpers": MODEL.front_bumpers,
        "rear_bumpers": MODEL.rear_bumpers,
        "sonar_max": 5.0,
    }
    assert len(robot["sonars"]) == 16


def test_a_robot_is_told_with_its_number_its_name_and_what_it_is_in_capitals() -> None:
    robot = said(robot_part(3, "left", info()))
    assert (robot["id"], robot["name"], robot["shape"]["name"]) == (3, "left", "dora")
    assert (robot["kind"], robot["url"]) == ("ROBOT", "serial:/dev/ttyUSB0")
    assert said(robot_part(1, "", info(serial="SIM")))["kind"] == "SIMULATOR"
    assert said(robot_part(1, "", info(name="MobileSim")))["kind"] == "SIMULATOR"


@pytest.mark.parametrize(
    ("told", "name"),
    [
        ("dora", "dora"),
        ("MobileSim", "Pioneer 3-DX"),
        ("AMRISim", "Pioneer 3-DX"),
        ("p3dx-sh", "Pioneer 3-DX"),
    ],
)
def test_a_robot_whose_name_says_nothing_is_called_by_its_type(told: str, name: str) -> None:
    assert called(info(name=told)) == name


def test_moderate_speeds_are_offered_to_begin_with() -> None:
    assert said(robot_part(1, "dora", info()))["limits"] == {
        "speed": 0.75,
        "turn_rate": 1.5,
        "default_speed": 0.3,
        "default_turn_rate": 0.6,
    }


def test_no_more_than_the_limits_is_ever_offered() -> None:
    slow = said(robot_part(1, "dora", info(Limits(max_speed=0.1, max_turn_rate=0.2))))
    assert (slow["limits"]["default_speed"], slow["limits"]["default_turn_rate"]) == (0.1, 0.2)


def test_hello_says_what_it_is() -> None:
    hello = said(messages.Hello("1.2", (), None, SCHEME, None))
    assert (hello["type"], hello["version"], hello["models"]) == ("hello", "1.2", None)


def test_a_robot_that_nobody_has_met_is_told_too() -> None:
    robot = said(robot_part(1, "dora", None))
    assert (robot["shape"], robot["limits"], robot["url"]) == (None, None, "")


def test_a_snapshot_says_what_the_reading_says() -> None:
    pose = Pose2(1.0, 2.0, 3.0)
    why, driver = Reason(ReasonKind.FAULT, "The motors are off."), messages.Driver(2, "ann")
    told = said(
        snapshot_part(
            4, reading(0.5), robot_in_map=pose, why=why, emergency_stop=True, driver=driver
        )
    )
    assert told["robot_in_map"] == {"x": 1.0, "y": 2.0, "theta": 3.0}
    assert told["twist"] == {"v": 0.5, "w": 0.5}
    assert (told["robot"], told["sequence"]) == (4, 7)
    assert (told["why"], told["standing"]) == ("The motors are off.", "fault")
    assert (told["emergency_stop"], told["driver"]) == (True, {"id": 2, "name": "ann"})
    assert told["motors"] == {
        "enabled": True,
        "stalled": True,
        "moving": False,
        "stop_button": False,
    }
    assert told["bumpers"] == {"front": [True, False], "rear": []}
    assert told["battery"]["voltage"] == 0.5
    assert told["battery"]["charge"] is None
    assert told["faults"] == ["over_current"]


def test_what_no_sonar_has_seen_is_null() -> None:
    told = said(
        snapshot_part(
            1, reading(), robot_in_map=Pose2(), why=None, emergency_stop=False, driver=None
        )
    )
    assert told["sonar"] == {"ranges": [1.5, None, None, 0.0], "enabled": True}


@pytest.mark.parametrize("number", [nan, inf, -inf])
def test_a_snapshot_is_strict_json_whatever_the_robot_says(number: float) -> None:
    pose = Pose2(number, number, number)
    told = said(
        snapshot_part(
            1, reading(number), robot_in_map=pose, why=None, emergency_stop=False, driver=None
        )
    )
    assert told["robot_in_map"] == {"x": None, "y": None, "theta": None}
    assert told["battery"]["voltage"] is None


@pytest.mark.parametrize(
    ("text", "request_"),
    [
        ('{"type":"drive","v":0.3,"w":-1}', requests.VelocityRequest(0.3, -1.0)),
        ('{"w":-1,"v":0.3,"type":"drive"}', requests.VelocityRequest(0.3, -1.0)),
        ('{"type":"drive","v":0.3,"w":-1,"robot":2}', requests.VelocityRequest(0.3, -1.0, robot=2)),
        ('{"type":"stop"}', requests.StopRequest()),
        ('{"type":"emergency_stop"}', requests.EmergencyStop()),
        ('{"type":"reset_emergency_stop"}', requests.ResetEmergencyStop()),
        ('{"type":"motors","on":true}', requests.SwitchMotors(on=True)),
        ('{"type":"ping","t":1.5}', requests.PingRequest(1.5)),
    ],
)
def test_every_request_is_understood(text: str, request_: requests.AnyRequest) -> None:
    assert requests.decode(text) == request_


@given(st.text() | st.recursive(st.none() | st.floats() | st.text(), st.lists).map(json.dumps))
def test_any_other_text_is_refused_and_never_breaks_the_decoder(text: str) -> None:
    with pytest.raises(msgspec.MsgspecError):
        requests.decode(text)


@given(st.floats(), st.floats())
def test_no_number_that_is_not_finite_gets_through(v: float, w: float) -> None:
    text = json.dumps({"type": "drive", "v": v, "w": w})
    try:
        request = requests.decode(text)
    except msgspec.MsgspecError:
        assert not Twist2(v, w).is_finite
    else:
        assert request == requests.VelocityRequest(v, w)
        assert Twist2(v, w).is_finite
