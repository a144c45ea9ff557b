"""The package that rosrun and roslaunch find."""

from pathlib import Path

import pytest

from tests.e2e.processes import p3
from tests.ros1.conftest import laboratory, simulated
from tests.ros1.master import ros, until_said
from tests.ros1.test_lasers import simulated as fitted

pytestmark = pytest.mark.realtime
FIXED = "Visualization Manager/Global Options/Fixed Frame"


@pytest.fixture
def package(ros1: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the installed package, which ROS finds."""
    done = p3("ros1", "--install-package", str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert f"export ROS_PACKAGE_PATH={tmp_path}:" in done.stdout
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{tmp_path}:/usr/share")
    return tmp_path / "pioneer3"


async def test_rosrun_starts_the_node_on_rosarias_kind_of_port(package: Path) -> None:
    async with simulated() as (_, url):
        port = f"_port:={url.removeprefix('tcp://')}"
        async with until_said("node /RosAria on", "rosrun", "pioneer3", "RosAria", port):
            assert "---" in await ros("rostopic", "echo", "-n", "1", "/RosAria/pose")


async def test_roslaunch_starts_the_node_by_any_name(package: Path) -> None:
    async with simulated() as (_, url):
        launch = ("roslaunch", "pioneer3", "pioneer3.launch", f"port:={url}", "name:=front")
        async with until_said("node /front on", *launch):
            assert "---" in await ros("rostopic", "echo", "-n", "1", "/front/pose")


async def test_rosarias_manual_and_launch_files_start_the_node(
    package: Path, tmp_path: Path
) -> None:
    launch = tmp_path / "lab.launch"
    async with simulated() as (_, url):
        port = f"_port:={url.removeprefix('tcp://')}"
        launch.write_text(
            f'<launch><node name="RosAria" pkg="rosaria" type="RosAria" args="{port}"'
            ' output="screen"/></launch>'
        )
        for command in (("rosrun", "rosaria", "RosAria", port), ("roslaunch", str(launch))):
            async with until_said("node /RosAria on", *command):
                assert "---" in await ros("rostopic", "echo", "-n", "1", "/RosAria/pose")


async def test_bumper_states_can_be_echoed_and_shown(package: Path) -> None:
    async with simulated() as (_, url):
        command = ("rosrun", "pioneer3", "RosAria", f"_port:={url}")
        async with until_said("node /RosAria on", *command):
            said = await ros("rostopic", "echo", "-n", "1", "/RosAria/bumper_state")
    assert "front_bumpers: [False, False, False, False, False]" in said
    assert "bool[] rear_bumpers" in await ros("rosmsg", "show", "rosaria/BumperState")


async def test_a_recording_can_be_shown_without_a_node(package: Path) -> None:
    launch = ("roslaunch", "--dump-params", "pioneer3", "rviz.launch")
    assert "p3dx" in await ros(*launch, "model:=p3dx")
    assert "robot_description" not in await ros(*launch)
    shown = package / "rviz" / "pioneer3.rviz"
    await ros("rosparam", "load", str(shown), "/shown")  # it is YAML
    try:
        assert (await ros("rosparam", "get", f"/shown/{FIXED}")).strip() == "odom"
    finally:
        await ros("rosparam", "delete", "/shown")


async def test_rosrun_starts_the_demos(package: Path) -> None:
    async with laboratory():
        done = await ros("rosrun", "pioneer3", "p3_sonar", "--robot", "RosAria", "--seconds", "1")
        assert done.splitlines()[0].split() == list("01234567")
        done = await ros("rosrun", "pioneer3", "robots", "__name:=mine")
        assert done.startswith("RosAria ")


async def test_launch_files_of_p2os_start_the_node_in_its_place(
    package: Path, tmp_path: Path
) -> None:
    launch = tmp_path / "p2os.launch"
    async with simulated() as (_, url):
        host, _, port = url.removeprefix("tcp://").partition(":")
        launch.write_text(
            '<launch><param name="/lab/tf_prefix" value="r7"/>'
            '<node pkg="p2os_driver" type="p2os_driver" name="p2os" ns="lab" output="screen">'
            f'<param name="use_tcp" value="true"/><param name="tcp_remote_host" value="{host}"/>'
            f'<param name="tcp_remote_port" value="{port}"/><param name="max_xspeed" value="0.2"/>'
            '<remap from="pose" to="odom"/></node></launch>'
        )
        async with until_said("node /lab/p2os on", "roslaunch", str(launch)):
            odometry = await ros("rostopic", "echo", "-n", "1", "/lab/odom")
            assert 'child_frame_id: "r7/base_link"' in odometry
            on = ("/lab/cmd_motor_state", "p2os_msgs/MotorState", "state: 1")
            await ros("rostopic", "pub", "-1", *on)
            assert "state: 1" in await ros("rostopic", "echo", "-n", "1", "/lab/motor_state")
            assert "ranges_count: 16" in await ros("rostopic", "echo", "-n", "1", "/lab/sonar")
            assert "voltage: 1" in await ros("rostopic", "echo", "-n", "1", "/lab/battery_state")
            assert "count: 8" in await ros("rostopic", "echo", "-n", "1", "/lab/dio")
            assert "voltages_count: 1" in await ros("rostopic", "echo", "-n", "1", "/lab/aio")


@pytest.mark.parametrize(
    ("laser", "node", "address"),
    [
        ("lms-200", 'pkg="sicktoolbox_wrapper" type="sicklms"', {"port": "tcp://{place}"}),
        ("lms-111", 'pkg="lms1xx" type="LMS1xx_node"', {"host": "{host}", "port": "{number}"}),
        ("utm-30lx", 'pkg="hokuyo_node" type="hokuyo_node"', {"port": "tcp://{place}"}),
    ],
)
async def test_launch_files_of_lasers_start_the_node_in_their_place(
    package: Path, tmp_path: Path, laser: str, node: str, address: dict[str, str]
) -> None:
    launch = tmp_path / "laser.launch"
    async with fitted(laser) as (_, url):
        place = url.removeprefix("tcp://")
        host, _, number = place.partition(":")
        name = laser.replace("-", "_")  # parameters stay at the master after a node's end
        address = {"frame_id": "front", **address}
        parameters = "".join(
            f'<param name="{each}" value="{value.format(place=place, host=host, number=number)}"/>'
            for each, value in address.items()
        )
        launch.write_text(
            f'<launch><node {node} name="{name}" output="screen">{parameters}'
            '<remap from="scan" to="scan_front"/></node></launch>'
        )
        async with until_said(f"node /{name} on", "roslaunch", str(launch)):
            said = await ros("rostopic", "echo", "-n", "1", "/scan_front/header/frame_id")
            assert said.startswith('"front"')


async def test_the_programs_of_manuals_are_in_the_package_rosaria(package: Path) -> None:
    for name in ("rob_key", "robotWander", "p3_sonar", "rob_key_multi_robot_con_separately"):
        said = await ros("rosrun", "rosaria", name, "--help")
        assert "pioneer3 ros1" in said
    assert "pioneer3 demo" in await ros("rosrun", "rosaria", "robotDemo", "--help")
