"""What ROS's own tools see of the node, against what they see of RosAria."""

import re

import pytest

from tests.ros1.conftest import Lab
from tests.ros1.master import ended, ros, script

pytestmark = [pytest.mark.realtime, pytest.mark.asyncio(loop_scope="module")]

NODE = "/RosAria"
TOPICS = {
    f"{NODE}/pose": ("nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7", "0", 713),
    "/tf": ("tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec", "0", 93),
    f"{NODE}/bumper_state": ("rosaria/BumperState", "f81947761ff7e166a3bbaf937b9869b5", "0", 41),
    f"{NODE}/battery_voltage": ("std_msgs/Float64", "fdb28210bfa9d7c91146260178d9a584", "0", 8),
    f"{NODE}/sonar": ("sensor_msgs/PointCloud", "d8e9c3f5afbdd8a130fd1d2763945fca", "0", 221),
    f"{NODE}/sonar_pointcloud2": (
        "sensor_msgs/PointCloud2",
        "1158d486dd51d683ce2f1be655c3c181",
        "0",
        281,
    ),
    f"{NODE}/battery_recharge_state": (
        "std_msgs/Int8",
        "27ffa0c9c4b8fb8492252bcad9e5c57b",
        "1",
        1,
    ),
    f"{NODE}/motors_state": ("std_msgs/Bool", "8b94c1b53db61fb6aed406028ad6332a", "1", 1),
    f"{NODE}/parameter_descriptions": (
        "dynamic_reconfigure/ConfigDescription",
        "757ce9d44ba8ddd801bb30bc456f946f",
        "1",
        None,
    ),
    f"{NODE}/parameter_updates": (
        "dynamic_reconfigure/Config",
        "958f16a05573709014982821e6822580",
        "1",
        220,
    ),
}
SILENT = {f"{NODE}/battery_state_of_charge": "std_msgs/Float32"}
"""Of a robot that cannot tell it."""
SERVICES = {
    f"{NODE}/enable_motors": "std_srvs/Empty",
    f"{NODE}/disable_motors": "std_srvs/Empty",
    f"{NODE}/set_parameters": "dynamic_reconfigure/Reconfigure",
    f"{NODE}/get_loggers": "roscpp/GetLoggers",
    f"{NODE}/set_logger_level": "roscpp/SetLoggerLevel",
}


async def test_every_topic_is_rosarias_to_the_byte(shared_lab: Lab) -> None:
    heard = await script("listen.py", "15", *TOPICS)
    found = {
        name: (row["type"], row["md5sum"], row["latching"], row["bytes"])
        for name, row in heard.items()
    }
    wanted = {
        name: (kind, md5, latching, found[name][3] if size is None else size)
        for name, (kind, md5, latching, size) in TOPICS.items()
        if name in found
    }
    assert set(found) == set(TOPICS)
    assert found == wanted


async def test_the_tools_list_the_topics_and_their_types(shared_lab: Lab) -> None:
    listed = set((await ros("rostopic", "list")).split())
    expected = {*TOPICS, *SILENT, f"{NODE}/cmd_vel", "/rosout"}
    assert expected <= listed
    assert {name for name in listed if name.startswith(f"{NODE}/")} == {
        name for name in expected if name.startswith(f"{NODE}/")
    }
    assert (await ros("rostopic", "type", f"{NODE}/cmd_vel")).strip() == "geometry_msgs/Twist"
    ((silent, kind),) = SILENT.items()
    assert (await ros("rostopic", "type", silent)).strip() == kind


async def test_the_services_are_rosarias(shared_lab: Lab) -> None:
    listed = (await ros("rosservice", "list")).split()
    assert {name for name in listed if name.startswith(NODE)} == set(SERVICES)
    for name, kind in SERVICES.items():
        assert (await ros("rosservice", "type", name)).strip() == kind


async def test_poses_come_ten_times_a_second(shared_lab: Lab) -> None:
    _, said = await ended("rostopic", "hz", f"{NODE}/pose", patience=8.0)
    rates = [float(rate) for rate in re.findall(r"average rate: ([\d.]+)", said)]
    assert min(abs(rate - 10.0) for rate in rates) < 0.1  # a busy machine bunches some of them


async def test_motors_go_on_and_off_by_service_and_stay_off(shared_lab: Lab) -> None:
    state = ("rostopic", "echo", "-n", "1", f"{NODE}/motors_state")
    assert "False" in await ros(*state)
    await ros("rosservice", "call", f"{NODE}/enable_motors")
    assert "True" in await echoed_until(state, "True")
    await ros("rosservice", "call", f"{NODE}/disable_motors")
    assert "False" in await echoed_until(state, "False")
    poses = await script("press.py", "0.3", "1.0")
    assert {x for x, *_ in poses} == {0.0}
    assert "False" in await ros(*state)


async def test_the_tree_of_frames_holds_the_robot(shared_lab: Lab) -> None:
    said = await ros("rostopic", "echo", "-n", "1", "/tf")
    assert 'frame_id: "odom"' in said
    assert 'child_frame_id: "base_link"' in said


async def test_settings_show_what_holds_and_keep_their_bounds(shared_lab: Lab) -> None:
    def setting(value: str) -> str:
        return f"{{config: {{doubles: [{{name: trans_accel, value: {value}}}]}}}}"

    assert float(await ros("rosparam", "get", f"{NODE}/trans_accel")) == pytest.approx(0.3)
    said = await ros("rosservice", "call", f"{NODE}/set_parameters", setting("50.0"))
    assert re.search(r'name: "trans_accel"\s+value: 2\.0\b', said)
    assert float(await ros("rosparam", "get", f"{NODE}/trans_accel")) == pytest.approx(2.0)
    await ros("rosservice", "call", f"{NODE}/set_parameters", setting(".nan"))
    assert float(await ros("rosparam", "get", f"{NODE}/trans_accel")) == pytest.approx(2.0)


async def echoed_until(command: tuple[str, ...], word: str) -> str:
    """Ask again until the answer has `word`; the robot takes its time."""
    for _ in range(10):
        said = await ros(*command)
        if word in said:
            break
    return said
