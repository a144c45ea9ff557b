"""The backend that is taken where nobody chooses one."""

import sys
from pathlib import Path

import pytest

from pioneer3.ros.ros2.network import BackendName, Network


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
