"""The fleet file: what it means, what is refused, where it is found."""

from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.fleet.inventory import find_fleet, parse_fleet, read_fleet, to_toml
from pioneer3.fleet.network import FleetNetwork
from pioneer3.fleet.spec import FleetRobot, OperatorComputer

LAB = """\
# The lab's robots.
[operator]
name = "laptop"
address = "192.168.1.10"

[defaults]
user = "robot"
ros = "1"

[[robot]]
name = "p3at-1"
address = "192.168.1.113"
note = "in room 246"

[[robot]]
name = "p3at-2"
host = "p3at-2.local"
address = "192.168.1.114"
port = "tcp://p3at-2.local:8101"
model = "p3at-sh"
laser = "lms-111@tcp:192.168.1.200"
ros = ""
node = "RosAria_p3at_2_114"

[groups]
front = ["p3at-2", "p3at-1"]
hall = ["p3at-2"]
"""
FAR = """\
[[network]]
name = "lab"
backend = "dds"
domain = 3

[[network]]
name = "far"
backend = "zenoh"
connect = ["tls/fleet.example.org:7447"]
ca = "tls/ca.pem"
certificate = "tls/laptop.pem"
key = "tls/laptop.key"
"""
TWO = '[[robot]]\nname = "a"\naddress = "10.0.0.1"\n[[robot]]\nname = "b"\naddress = "10.0.0.2"\n'


def test_a_robot_has_its_own_fields_and_the_defaults() -> None:
    fleet = parse_fleet(Path("fleet.toml"), LAB)
    assert fleet.operator == OperatorComputer(name="laptop", address="192.168.1.10")
    first, second = fleet.robots
    assert first == FleetRobot(
        name="p3at-1",
        host="p3at-1",
        address="192.168.1.113",
        port="/dev/ttyUSB0",
        user="robot",
        model="",
        ros="1",
        node="RosAria_p3at_1",
        note="in room 246",
    )
    assert (first.line, second.line) == (10, 15)
    assert (first.endpoint, second.endpoint) == (None, ("p3at-2.local", 8101))
    assert (second.user, second.ros, second.node) == ("robot", "", "RosAria_p3at_2_114")


def test_robots_of_ros_2_are_on_the_first_network_or_on_the_one_they_name() -> None:
    text = FAR + TWO + 'ros = "2"\nnetwork = "far"\nnode = "/arm/base"\n'
    fleet = parse_fleet(Path("lab/fleet.toml"), text.replace('"10.0.0.1"', '"10.0.0.1"\nros = "2"'))
    near, far = fleet.robots
    assert (near.node, far.node) == ("a/pioneer3", "/arm/base")
    assert (fleet.network(near).name, fleet.network(near).domain) == ("lab", 3)
    assert fleet.network(far).connect == ("tls/fleet.example.org:7447",)
    assert fleet.network(far).file("key", fleet.path.parent) == Path("lab/tls/laptop.key")
    assert fleet.network(far).file("credentials", fleet.path.parent) is None
    tuned = parse_fleet(fleet.path, f"{text}navigation.planner.margin = 0.05\n")
    assert parse_fleet(fleet.path, to_toml(tuned)) == tuned
    alone = parse_fleet(Path("fleet.toml"), TWO)
    assert alone.network(alone.robots[0]) == FleetNetwork(name="")
    assert parse_fleet(fleet.path, to_toml(fleet)) == fleet


def test_names_groups_and_all_select_robots() -> None:
    fleet = parse_fleet(Path("fleet.toml"), LAB)
    assert [robot.name for robot in fleet.select(["front"])] == ["p3at-1", "p3at-2"]
    assert [robot.name for robot in fleet.select(["hall", "p3at-2"])] == ["p3at-2"]
    assert fleet.select(["all"]) == fleet.robots
    assert fleet.select([]) == ()
    with pytest.raises(ConfigError, match=r"fleet.toml: no robot 'p3at1', did you mean p3at-1\?"):
        fleet.select(["p3at1"])
    with pytest.raises(ConfigError, match="front is a group; one robot is needed here"):
        fleet.robot("front")


def test_an_empty_file_is_a_fleet_without_robots() -> None:
    fleet = parse_fleet(Path("fleet.toml"), "")
    assert (fleet.robots, to_toml(fleet)) == ((), "")
    with pytest.raises(ConfigError, match=r"it has no robot yet; add one as \[\[robot\]\]"):
        fleet.select(["p3at-1"])


def test_a_model_file_is_looked_for_beside_the_fleet_file(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text('like = "p3at"\n')
    path = tmp_path / "fleet.toml"
    path.write_text(TWO + 'model = "mine.toml"\n')
    assert read_fleet(path).robots[1].model == "mine.toml"
    path.write_text(TWO + 'model = "other.toml"\n')
    with pytest.raises(ConfigError, match=r"fleet.toml:7: robot\[1\].model: .*other.toml: cannot"):
        read_fleet(path)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[[robots]]", "f.toml:1: robots: unknown key, did you mean robot?"),
        ("[robot]", "f.toml:1: robot: expected [[robot]], with two brackets"),
        ("robot = [{ nme = 1 }]", "f.toml:1: robot[0].nme: unknown key, did you mean name?"),
        ("operator.nme = 1", "f.toml:1: operator.nme: unknown key, did you mean name?"),
        ('[["robot"]]\nname = "a"', "f.toml:1: robot[0].address: missing, add it"),
        ('[[robot]]\naddress = "10.0.0.1"', "f.toml:1: robot[0].name: missing, add it"),
        (TWO + 'name = "c"', "f.toml:7: not valid TOML: Cannot overwrite a value"),
        (TWO + "ros = 1", 'f.toml:7: robot[1].ros: expected "1" or "2", or "" for none, got 1'),
        (TWO + "bridge = 70000", "f.toml:7: robot[1].bridge: expected a TCP port such as 8101"),
        (
            TWO + 'network = "lab"',
            "f.toml:7: robot[1].network: no network 'lab', the file has none",
        ),
        (
            FAR + TWO + 'network = "lob"',
            "f.toml:19: robot[1].network: no network 'lob', did you mean lab?",
        ),
        (FAR + 'name = "b"', "f.toml:13: not valid TOML"),
        (
            FAR + '[[network]]\nname = "far"',
            "f.toml:14: network[2].name: far is network[1]'s already",
        ),
        (
            FAR + 'interface = ["wlan0"]',
            "f.toml:13: network[1].interface: the backend zenoh has no use for it; leave it out",
        ),
        (
            FAR.replace('backend = "zenoh"', 'backend = "zeno"'),
            'f.toml:8: network[1].backend: expected "dds", "zenoh", "rclpy" or "auto"',
        ),
        (
            FAR.replace("domain = 3", "domain = 300"),
            "f.toml:4: network[0].domain: expected the num",
        ),
        (FAR.replace("domain = 3", 'distro = "foxy"'), "f.toml:4: network[0].distro: expected"),
        (FAR.replace('key = "', '# "'), "f.toml:11: network[1].certificate: a certificate and its"),
        (
            FAR.replace("org:7447", "org"),
            "f.toml:9: network[1].connect[0]: expected a Zenoh router such as tls/",
        ),
        (
            FAR.replace("org:7447", "org:7447#connect_private_key_base64=c2VjcmV0"),
            "f.toml:9: network[1].connect[0]: settings of an endpoint belong in files",
        ),
        (FAR + 'password = "secret"', "f.toml:13: network[1].password: unknown key"),
        (
            TWO + 'port = "tcp://b:8101"\nbridge = 8101',
            "f.toml:8: robot[1].bridge: tcp://b:8101 is reached by others as it is; leave bridge",
        ),
        (
            TWO + 'ros = "1"\nbridge = 8101',
            "f.toml:8: robot[1].bridge: the node of ROS 1 has the port; leave ros or bridge out",
        ),
        (TWO + 'port = ""', "f.toml:7: robot[1].port: '' names no port; use one of: /dev/ttyUSB0"),
        (
            "[defaults]\nbridge = 8101\n" + TWO + 'port = "x"',
            "f.toml:9: robot[1].port: 'x' names no port; use one of: /dev/ttyUSB0",
        ),
        (TWO + 'user = "a b"', "f.toml:7: robot[1].user: expected the name of a user such as"),
        (TWO + 'host = "A"', "f.toml:7: robot[1].host: A is robot[0]'s already"),
        (TWO + 'node = "RosAria_a"', "f.toml:7: robot[1].node: RosAria_a is robot[0]'s already"),
        (
            TWO.replace("[[robot]]", '[[robot]]\nport = "tcp://b:8101"'),
            "f.toml:6: robot[1].port: tcp://b:8101 is robot[0]'s already",
        ),
        (
            TWO.replace('"10.0.0.1"', '"10.0.0.1"\nport="tcp://10.0.0.2"', 1) + 'port="b:8101"',
            "f.toml:8: robot[1].port: b:8101 is robot[0]'s already",
        ),
        (
            '[defaults]\nport = "ttyS0"',
            "f.toml:2: defaults.port: 'ttyS0' names no port, did you mean /dev/ttyS0?",
        ),
        ('[defaults]\nport = "replay:a.log"', "f.toml:2: defaults.port: 'replay:a.log' is a reco"),
        ('[defaults]\nmodel = "p3az"', "f.toml:2: defaults.model: 'p3az': no such robot model, d"),
        ('[defaults]\ncamera = "cam"', "f.toml:2: defaults.camera: cam: no URL of a camera"),
        (
            '[defaults]\nlaser = "ttyS0"',
            "f.toml:2: defaults.laser: 'ttyS0' names no port, did you mean",
        ),
        ('[operator]\naddress = "10.0.0.256"', "f.toml:2: operator.address: expected an IP addre"),
        ('[operator]\nname = "a"\n' + TWO, "f.toml:2: operator.name: a is robot[0]'s"),
        ('[operator]\naddress = "10.0.0.2"\n' + TWO, "f.toml:2: operator.address: 10.0.0.2 is ro"),
        ("[groups]\nfront = 1", 'f.toml:2: groups.front: expected a list of robots, such as ["p3'),
        (TWO + '[groups]\na = ["b"]', "f.toml:8: groups.a: a is a robot already; take another"),
        (TWO + '[groups]\nall = ["b"]', "f.toml:8: groups.all: all is the group of all robots"),
        (TWO + '[groups]\nx = ["b", "c"]', "f.toml:8: groups.x[1]: no robot 'c', known are a, b"),
        (TWO + '[groups]\nx = ["b", "b"]', "f.toml:8: groups.x[1]: b is in the group already"),
        (TWO + '[groups]\n"a b" = ["b"]', "f.toml:8: groups.a b: a group's name has letters, di"),
        (TWO.replace("10.0.0.2", "10.0.0.02"), "f.toml:6: robot[1].address: expected an IP addre"),
        (TWO.replace("10.0.0.2", "0::1"), "f.toml:6: robot[1].address: 0::1 is written ::1"),
        (TWO.replace('"a"', '"localhost"'), "f.toml:2: robot[0].name: localhost means something"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(text: str, complaint: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_fleet(Path("f.toml"), text)
    assert str(caught.value).startswith(complaint)
    assert str(caught.value).isprintable()


def test_what_is_no_fleet_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot read this fleet file: No such file"):
        read_fleet(tmp_path / "fleet.toml")
    with pytest.raises(ConfigError, match="is a directory, not a fleet file"):
        read_fleet(tmp_path)


def test_the_file_is_found_in_this_order(tmp_path: Path) -> None:
    here, home = tmp_path / "here", tmp_path / "home"
    usual = home / ".config/pioneer3/fleet.toml"
    usual.parent.mkdir(parents=True)
    here.mkdir()
    named = {"PIONEER3_FLEET": "lab.toml"}
    with pytest.raises(ConfigError, match=r"no fleet file: .* make one with pioneer3 fleet init"):
        find_fleet(None, environment={}, here=here, home=home)
    usual.touch()
    assert find_fleet(None, environment={}, here=here, home=home) == usual
    (here / "fleet.toml").touch()
    assert find_fleet(None, environment={}, here=here, home=home) == here / "fleet.toml"
    assert find_fleet(None, environment=named, here=here, home=home) == Path("lab.toml")
    assert find_fleet(Path("f"), environment=named, here=here, home=home) == Path("f")


def test_a_default_bridge_is_for_robots_whose_device_nobody_else_has() -> None:
    rows = (
        "[defaults]\nbridge = 8101\n"
        '[[robot]]\nname = "a"\naddress = "10.0.0.1"\n'
        '[[robot]]\nname = "b"\naddress = "10.0.0.2"\nros = "1"\n'
        '[[robot]]\nname = "c"\naddress = "10.0.0.3"\nport = "tcp://c:8101"\n'
    )
    fleet = parse_fleet(Path("fleet.toml"), rows)
    assert [robot.bridge for robot in fleet.robots] == [8101, 0, 0]
    assert parse_fleet(fleet.path, to_toml(fleet)).robots == fleet.robots
