"""A robot by its name: its port if others reach it, else what to do."""

from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.fleet.inventory import parse_fleet
from pioneer3.fleet.reach import camera_of, laser_of, named, port_of
from pioneer3.fleet.simulated import simulated

FLEET = parse_fleet(
    Path("fleet.toml"),
    """\
[[robot]]
name = "near"
address = "127.0.0.1"
camera = "http://localhost:8181/"
laser = "/dev/ttyACM0"
[[robot]]
name = "far"
address = "192.0.2.7"
camera = "http://localhost:8080/?action=stream"
laser = "/dev/ttyACM0"
[[robot]]
name = "served"
address = "192.0.2.8"
port = "tcp://Served:8102"
camera = "http://192.0.2.9/video"
model = "p3dx-sh"
laser = "lms-111@tcp:192.0.2.9"
[[robot]]
name = "six"
address = "fd00::7"
port = "tcp://six"
camera = "https://127.0.0.1/a"
laser = "auto"
[[robot]]
name = "elsewhere"
address = "192.0.2.10"
port = "bridge.lab:8102"
[[robot]]
name = "bridged"
address = "192.0.2.11"
bridge = 8103
[groups]
front = ["near", "far"]
""",
)


@pytest.mark.parametrize(
    ("name", "port"),
    [
        ("near", "/dev/ttyUSB0"),
        ("served", "tcp://192.0.2.8:8102"),
        ("six", "tcp://[fd00::7]:8101"),
        ("elsewhere", "tcp://bridge.lab:8102"),
        ("bridged", "tcp://192.0.2.11:8103"),
    ],
)
def test_a_name_stands_for_a_port_that_is_reached_from_here(name: str, port: str) -> None:
    assert port_of(FLEET, name) == port


def test_a_device_of_another_computer_is_refused_with_what_to_do() -> None:
    with pytest.raises(ConfigError) as caught:
        port_of(FLEET, "far")
    message = str(caught.value)
    assert message.startswith("fleet.toml:6: far is at /dev/ttyUSB0, a device of far (192.0.2.7)")
    assert "after ssh pioneer@192.0.2.7" in message
    assert "say bridge = 8101" in message


def test_a_laser_is_taken_where_it_is_reached_from_here() -> None:
    lasers = {robot.name: laser_of(robot) for robot in FLEET.robots}
    assert lasers == {
        "near": "/dev/ttyACM0",
        "far": "",
        "served": "lms-111@tcp:192.0.2.9",
        "six": "",
        "elsewhere": "",
        "bridged": "",
    }


def test_a_camera_on_loopback_is_looked_for_on_the_robots_computer() -> None:
    cameras = {robot.name: camera_of(robot) for robot in FLEET.robots}
    assert cameras == {
        "near": "http://localhost:8181/",
        "far": "http://192.0.2.7:8080/?action=stream",
        "served": "http://192.0.2.9/video",
        "six": "https://[fd00::7]/a",
        "elsewhere": None,
        "bridged": None,
    }


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (["near"], ["near"]),
        (["front", "served"], ["near", "far", "served"]),
        (["p3at"], []),
        (["p3dx:near", "mine.toml"], []),
        (["unknown"], []),
    ],
)
def test_words_are_robots_or_models(words: list[str], names: list[str]) -> None:
    assert [robot.name for robot in named(words, FLEET)] == names


@pytest.mark.parametrize("words", [["near", "p3at"], ["near", "unknown"]])
def test_words_of_both_kinds_are_refused(words: list[str]) -> None:
    with pytest.raises(ConfigError):
        named(words, FLEET)


def test_simulated_robots_listen_on_loopback_at_the_ports_of_their_rows() -> None:
    specs = simulated(FLEET)
    assert [(each.name, each.model, each.host, each.port) for each in specs] == [
        ("near", "p3at", "127.0.0.1", None),
        ("far", "p3at", "", None),
        ("served", "p3dx-sh", "", 8102),
        ("six", "p3at", "", 8101),
        ("elsewhere", "p3at", "", None),
        ("bridged", "p3at", "", 8103),
    ]


def test_every_address_of_loopback_has_ports_of_its_own() -> None:
    rows = "".join(
        f'[[robot]]\nname = "r{n}"\naddress = "127.0.0.{n}"\nport = "tcp://r{n}:8101"\n'
        for n in (1, 2)
    )
    fleet = parse_fleet(Path("fleet.toml"), rows)
    assert [(each.host, each.port) for each in simulated(fleet)] == [
        ("127.0.0.1", 8101),
        ("127.0.0.2", 8101),
    ]
    assert [(each.host, each.port) for each in simulated(fleet, "0.0.0.0", network=True)] == [
        ("", 8101),
        ("", None),
    ]


def test_a_simulated_robot_listens_where_its_port_says_not_at_its_computers_address() -> None:
    rows = (
        '[[robot]]\nname = "a"\naddress = "127.0.0.2"\nport = "tcp://127.0.0.3:8101"\n'
        '[[robot]]\nname = "b"\naddress = "127.0.0.4"\nbridge = 8102\n'
        '[[robot]]\nname = "c"\naddress = "127.0.0.5"\nport = "tcp://elsewhere:8103"\n'
    )
    fleet = parse_fleet(Path("fleet.toml"), rows)
    assert [(each.host, each.port) for each in simulated(fleet)] == [
        ("127.0.0.3", 8101),
        ("127.0.0.4", 8102),
        ("", 8103),
    ]


def test_a_fleet_without_robots_is_not_simulated() -> None:
    with pytest.raises(ConfigError, match="no robot to simulate"):
        simulated(parse_fleet(Path("fleet.toml"), ""))
