"""The backend that is taken where nobody chooses one."""

import sys
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from pioneer3.errors import ConfigError
from pioneer3.ros.rclpy.backend import reach
from pioneer3.ros.ros2.network import KEEPERS, BackendName, Network


@pytest.fixture
def rclpy_of_another_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let an rclpy be found that this Python cannot import, as after `source setup.bash`."""
    package = tmp_path / "rclpy"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "node.py").write_text("import rclpy._rclpy_pybind11\n")
    monkeypatch.syspath_prepend(tmp_path)
    for name in [name for name in sys.modules if name.partition(".")[0] == "rclpy"]:
        monkeypatch.delitem(sys.modules, name)


@pytest.mark.usefixtures("rclpy_of_another_python")
def test_an_rclpy_of_another_python_is_not_taken() -> None:
    network = Network(distro="humble")
    assert network.chosen({}) is BackendName.DDS
    assert "source /opt/ros/humble/setup.bash" in network.obstacle()
    assert Network(backend=BackendName.ZENOH).obstacle() == ""
    sys.modules.pop("rclpy", None)


def test_zenoh_comes_first_for_its_users() -> None:
    assert Network().chosen({}) is BackendName.DDS
    assert Network().chosen({"RMW_IMPLEMENTATION": "rmw_zenoh_cpp"}) is BackendName.ZENOH
    assert Network(connect=("tcp/127.0.0.1:7447",)).chosen({}) is BackendName.ZENOH
    assert Network(listen=("tcp/0.0.0.0:7447",)).chosen({}) is BackendName.ZENOH


@pytest.mark.parametrize(
    ("given", "chosen", "words"),
    [
        ({"interface": ("wlan0",)}, "rclpy", ("--interface", "DISCOVERY_RANGE=SUBNET", "dds")),
        ({"peer": ("10.0.0.1",)}, "rclpy", ("--peer", "ROS_STATIC_PEERS", "dds")),
        ({"dds_services": True}, "rclpy", ("--dds-services", "without it", "dds")),
        ({"listen": ("tcp/0.0.0.0:1",)}, "rclpy", ("--listen", "ZENOH_SESSION", "zenoh")),
        ({"interface": ("wlan0",)}, "zenoh", ("zenoh has no --interface: take --backend dds",)),
        ({"key": Path("key.pem")}, "dds", ("dds has no --key: take --backend zenoh",)),
    ],
)
def test_options_that_a_backend_does_not_keep_are_refused(
    given: dict[str, Any], chosen: str, words: tuple[str, ...]
) -> None:
    with pytest.raises(ConfigError) as refused:
        Network(**given).check(BackendName(chosen))
    assert all(word in str(refused.value) for word in words)


def test_every_option_of_a_network_has_its_backend() -> None:
    everywhere = {"backend", "distro", "domain"}
    assert {each.name for each in fields(Network)} - everywhere == set(KEEPERS)
    for name, backend in KEEPERS.items():
        given: dict[str, Any] = {name: "given"}
        Network(**given).check(backend)


@pytest.mark.parametrize(
    ("variables", "who"),
    [
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, "this computer only"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "localhost", "ROS_STATIC_PEERS": "a;b"}, "and a;b"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}, "all computers around"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, "nobody"),
        ({}, "all computers around"),
    ],
)
def test_who_reaches_a_node_by_rclpy_is_said(variables: dict[str, str], who: str) -> None:
    assert who in reach(variables, "rmw_fastrtps_cpp")
    assert "router" in reach(variables, "rmw_zenoh_cpp")
