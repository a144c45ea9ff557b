"""The systemd unit: what it starts, as whom, and that systemd takes it."""

import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.fleet.bundle import Bundler, Platform, here, installed, suits, version_pair
from pioneer3.fleet.network import FleetNetwork
from pioneer3.fleet.spec import Fleet, FleetRobot, OperatorComputer
from pioneer3.fleet.unit import SystemdUnit, check_unit, quoted, unit_of

ROBOT = FleetRobot(name="p3at-1", host="p3at-1", address="192.168.1.111", node="RosAria_p3at_1")
FLEET = Fleet(
    path=Path("fleet.toml"),
    operator=OperatorComputer(name="laptop", address="192.168.1.10"),
    robots=(ROBOT,),
)


def unit(robot: FleetRobot = ROBOT, *, with_root: bool = True) -> SystemdUnit:
    return unit_of(robot, FLEET, sys.executable, with_root=with_root)


def test_it_drives_as_the_user_in_dialout_and_comes_back() -> None:
    lines = unit(replace(ROBOT, laser="lms-200@/dev/ttyUSB1")).text().splitlines()
    command = f"{sys.executable} -m pioneer3 run --port /dev/ttyUSB0"
    assert f"ExecStart={command} --laser lms-200@/dev/ttyUSB1" in lines
    assert {"User=pioneer", "SupplementaryGroups=dialout", "Restart=always"} <= set(lines)
    assert {"KillSignal=SIGTERM", "NoNewPrivileges=yes", "WantedBy=multi-user.target"} <= set(lines)


def test_its_camera_is_read_too_and_signs_of_its_url_are_kept() -> None:
    url = "http://a:50%@10.0.0.9/?x=$y"
    text = unit(replace(ROBOT, camera=url)).text()
    assert "--port /dev/ttyUSB0 --camera http://a:50%%@10.0.0.9/?x=$$y\n" in text


def test_the_unit_of_a_user_asks_for_nothing_that_needs_root() -> None:
    text = unit(with_root=False).text()
    assert "WantedBy=default.target" in text
    assert not any(word in text for word in ("User=", "Protect", "Device", "network-online"))


def test_with_ros_it_is_the_node_at_the_operators_master() -> None:
    text = unit(replace(ROBOT, ros="1")).text()
    assert "pioneer3 ros1 --port /dev/ttyUSB0 __name:=RosAria_p3at_1\n" in text
    assert "Environment=ROS_MASTER_URI=http://192.168.1.10:11311\n" in text
    assert "Environment=ROS_IP=192.168.1.111\n" in text


def test_with_ros_2_it_is_the_node_on_its_network_at_its_own_address() -> None:
    lab = FleetNetwork(name="lab", backend="dds", distro="jazzy", domain=3, interface=("wlan0",))
    fleet = replace(FLEET, networks=(lab,))
    robot = replace(ROBOT, ros="2", node="p3at_1/pioneer3")
    text = unit_of(robot, fleet, sys.executable, with_root=True).text()
    node = "--namespace p3at_1 --name pioneer3 --backend dds --distro jazzy --domain 3"
    command = f"pioneer3 ros2 --port /dev/ttyUSB0 {node} --interface 192.168.1.111\n"
    assert command in text
    far = FleetNetwork(name="far", backend="zenoh", connect=("tls/a:7447",), ca="ca.pem")
    with pytest.raises(ConfigError, match=r"network far has certificates .* p3at-1 needs its own"):
        check_unit(robot, replace(FLEET, networks=(far,)))


def test_with_a_bridge_it_lets_others_reach_the_device_at_the_robots_address() -> None:
    text = unit(replace(ROBOT, bridge=8101)).text()
    command = "pioneer3 bridge --port /dev/ttyUSB0 --bind 192.168.1.111 --listen 8101\n"
    assert command in text
    assert "Description=pioneer3 bridges the robot p3at-1\n" in text


@pytest.mark.parametrize(
    ("word", "written"),
    [
        ("plain", "plain"),
        ("", '""'),
        ("two words", '"two words"'),
        ('a"b', '"a\\"b"'),
        ("50%$HOME", "50%%$$HOME"),
        ("a\\b", "a\\\\b"),
        ("a\nUser=root", "a\\nUser=root"),
    ],
)
def test_words_are_quoted_for_systemd(word: str, written: str) -> None:
    assert quoted(word) == written


@pytest.mark.realtime
@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="no systemd-analyze here")
@pytest.mark.parametrize("with_root", [True, False])
@pytest.mark.parametrize("ros", ["", "1"])
def test_systemd_takes_it(ros: str, with_root: bool, tmp_path: Path) -> None:
    path = tmp_path / "pioneer3.service"
    path.write_text(unit(replace(ROBOT, ros=ros, user="root"), with_root=with_root).text())
    words = ["systemd-analyze", "verify", "--man=no", str(path)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    assert str(path) not in done.stderr, done.stderr
    assert "pioneer3.service" not in done.stderr, done.stderr
    assert done.returncode == 0, done.stderr
    path.write_text(path.read_text().replace("Restart=always", "Restart=sometimes"))
    wrong = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    assert "sometimes" in wrong.stderr


def test_packages_of_here_go_to_computers_like_this_one_only() -> None:
    ours = Platform("x86_64", (3, 11), (2, 36))
    assert suits(ours, ours)
    assert suits(ours, Platform("x86_64", (3, 11), (2, 40)))
    assert not suits(ours, Platform("x86_64", (3, 11), (2, 31)))
    assert not suits(ours, Platform("x86_64", (3, 12), (2, 36)))
    assert not suits(ours, Platform("aarch64", (3, 11), (2, 36)))
    assert here().python == sys.version_info[:2]


def test_what_this_package_needs_is_found_with_what_that_needs() -> None:
    needed = installed("pioneer3", ())
    assert {"rich", "numpy", "serialx", "anyio"} <= set(needed)  # anyio is starlette's
    assert "numba" not in needed
    assert {"numba", "llvmlite", "scipy"} <= set(installed("pioneer3", ("nav",)))


@pytest.mark.realtime  # a thread makes it
async def test_a_processor_without_packages_is_told(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="no packages for its processor armv7l"):
        await Bundler(tmp_path).bundle(Platform("armv7l", (3, 11), (2, 36)))


@pytest.mark.parametrize(("text", "pair"), [("2.36", (2, 36)), ("3.11.2", (3, 11)), ("x", None)])
def test_versions(text: str, pair: tuple[int, int] | None) -> None:
    assert version_pair(text) == pair
