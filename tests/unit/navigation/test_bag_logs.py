"""Rosbags as logs."""

from collections.abc import Iterator
from contextlib import suppress
from math import inf, pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.logged import LoggedOdometry, LoggedPlace, LoggedScan, Sources
from pioneer3.navigation.log_files import opened_log
from pioneer3.state import Scan
from tests.unit.navigation.bags import ROS_1, BagWriter

MOUNT = Pose2(0.2, 0.0, pi / 2)


def scans(path: Path, laser: str | None = None, odometry: str | None = None) -> list[Scan]:
    with opened_log(path) as log:
        chosen = laser or log.sources.lasers[0], odometry or log.sources.odometry[0]
        entries = list(log.entries(*chosen))
    return [entry.scan for entry in entries if isinstance(entry, LoggedScan)]


def sources(path: Path) -> Sources:
    with opened_log(path) as log:
        return log.sources


def notes(path: Path) -> list[str]:
    with opened_log(path) as log:
        list(log.entries(log.sources.lasers[0], log.sources.odometry[0]))
        return log.notes


def parts(pose: Pose2) -> tuple[float, float, float]:
    return pose.x, pose.y, pose.theta


@pytest.mark.parametrize(
    ("storage", "compression", "file"),
    [
        (ROS_1, None, ""),
        (ROS_1, "BZ2", ""),
        (ROS_1, "LZ4", ""),
        ("sqlite3", None, ""),
        ("sqlite3", None, "bag.db3"),
        ("mcap", None, "metadata.yaml"),
        ("mcap", None, "bag.mcap"),
    ],
)
def test_a_bag_of_each_format_gives_scans_with_the_odometry_of_their_time(
    tmp_path: Path, storage: str, compression: str | None, file: str
) -> None:
    path = tmp_path / "bag"
    with BagWriter(path, storage, compression) as writer:
        writer.transform(10.0, "base_link", "laser", MOUNT, topic="/tf_static")
        writer.transform(10.0, "map", "odom", Pose2(5.0, 5.0))
        writer.transform(10.0, "odom", "base_link")
        writer.scan(10.5, [1.0, inf, 0.05, 30.0], beam_time=0.1)
        writer.transform(11.0, "odom", "base_link", Pose2(1.0, 0.0, 0.4))
    (scan,) = scans(path / file)
    assert parts(scan.robot_in_odom) == pytest.approx((0.5, 0.0, 0.2))
    assert scan.last_in_odom is not None
    assert scan.last_in_odom.x == pytest.approx(0.8)
    assert parts(scan.sensor_in_robot) == pytest.approx((0.2, 0.0, pi / 2))
    assert scan.ranges == (1.0, inf, -inf, inf)
    assert scan.angles == pytest.approx((-0.1, 0.0, 0.1, 0.2))
    assert scan.stamp == pytest.approx(10.5)


def test_a_level_laser_then_one_on_scan_then_that_with_most_scans_comes_first(
    tmp_path: Path,
) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        tilted = (0.0, sqrt(0.5), 0.0, sqrt(0.5))
        writer.transform(1.0, "base_link", "tilted", topic="/tf_static", turned=tilted)
        for number in range(3):
            writer.scan(1.0, [1.0, 1.0], topic="/tilted/scan", frame="tilted")
            writer.scan(1.0, [1.0, 1.0], topic="/front/scan")
            writer.odometry(1.0 + number, ORIGIN, "/wheels")
        writer.scan(2.0, [1.0, 1.0], topic="/rear/scan")
        writer.odometry(2.0, ORIGIN, "/odom")
        for _ in range(5):
            writer.scan(3.0, [1.0, 1.0], topic="/base_laser")
    assert sources(tmp_path / "bag") == Sources(
        ("/front/scan", "/rear/scan", "/base_laser", "/tilted/scan"), ("/odom", "/wheels")
    )


def test_odometry_beside_the_laser_in_its_namespace_comes_first(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        writer.scan(1.0, [1.0, 1.0], topic="/r2/scan")
        writer.odometry(1.0, ORIGIN, "/r1/odom")
        writer.odometry(1.0, ORIGIN, "/r2/pose")
    assert sources(tmp_path / "bag").odometry == ("/r2/pose", "/r1/odom")


def test_a_transform_that_moves_what_carries_the_laser_is_odometry_if_nothing_else_is(
    tmp_path: Path,
) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        writer.transform(1.0, "base_link", "laser", MOUNT)
        for time in (1.0, 2.0):
            writer.transform(time, "world", "base_link", Pose2(time))
        writer.scan(1.0, [1.0, 1.0], frame="/laser")
    (scan,) = scans(tmp_path / "bag")
    assert scan.robot_in_odom == Pose2(1.0)
    assert scan.sensor_in_robot.x == pytest.approx(0.2)


def test_a_laser_that_hangs_head_down_is_seen_from_above(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        writer.transform(1.0, "base_link", "laser", topic="/tf_static", turned=(1.0, 0, 0, 0))
        writer.odometry(1.0, ORIGIN)
        writer.scan(1.0, [1.0, 2.0, 3.0, 4.0], beam_time=0.1)
        writer.odometry(2.0, Pose2(1.0))
    (scan,) = scans(tmp_path / "bag")
    assert scan.angles == pytest.approx((-0.2, -0.1, 0.0, 0.1))
    assert scan.ranges == (4.0, 3.0, 2.0, 1.0)
    assert scan.last_in_odom == ORIGIN
    assert scan.robot_in_odom.x == pytest.approx(0.3)


def test_a_laser_that_turns_clockwise_is_read_the_other_way_round(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        writer.odometry(1.0, ORIGIN)
        writer.scan(1.0, [1.0, 2.0, 3.0], step=-0.1)
    (scan,) = scans(tmp_path / "bag")
    assert scan.angles == pytest.approx((-0.3, -0.2, -0.1))
    assert scan.ranges == (3.0, 2.0, 1.0)
    assert notes(tmp_path / "bag") == [
        "no transform tells where laser is on the robot: taken to be in its middle; else give "
        "--laser-pose x,y,heading"
    ]


def test_of_several_echoes_the_nearest_counts(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        writer.odometry(1.0, ORIGIN)
        beams = [
            writer.make("sensor_msgs/msg/LaserEcho", echoes=np.array(each, dtype=np.float32))
            for each in ([1.0, 5.0], [], [2.0])
        ]
        writer.put(
            "/echoes",
            "sensor_msgs/msg/MultiEchoLaserScan",
            1.0,
            header=writer.header(1.0, "laser"),
            angle_min=0.0,
            angle_max=0.2,
            angle_increment=0.1,
            time_increment=0.0,
            scan_time=0.0,
            range_min=0.1,
            range_max=30.0,
            ranges=beams,
            intensities=[],
        )
    (scan,) = scans(tmp_path / "bag")
    assert scan.ranges == (1.0, inf, 2.0)


def test_a_scan_that_comes_late_is_told_in_the_order_of_time(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        for number in range(20):
            writer.odometry(1.0 + 0.1 * number, Pose2(0.1 * number))
        writer.scan(2.05, [1.0, 1.0], at=2.95)
        writer.odometry(3.0, Pose2(2.0))
    with opened_log(tmp_path / "bag") as log:
        entries = list(log.entries("/scan", "/odom"))
    ways = [
        entry.scan.robot_in_odom.x if isinstance(entry, LoggedScan) else entry.robot_in_odom.x
        for entry in entries
        if not isinstance(entry, LoggedPlace)
    ]
    assert ways == sorted(ways)
    assert len(ways) == 22


def test_scans_whose_clock_differs_have_the_odometry_before_them_in_the_bag(
    tmp_path: Path,
) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        for number in range(1, 4):
            writer.odometry(100.0 + number, Pose2(float(number)))
            writer.scan(9000.0 + number, [1.0, 1.0])
    with opened_log(tmp_path / "bag") as log:
        entries = list(log.entries("/scan", "/odom"))
    kinds = [type(entry) for entry in entries]
    assert kinds.count(LoggedOdometry) == kinds.count(LoggedScan) == 3


def test_a_bag_without_scans_names_its_topics(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "a.bag", ROS_1) as writer:
        writer.odometry(1.0, ORIGIN)
    with (
        pytest.raises(
            ConfigError,
            match=r"a\.bag: is a rosbag of ROS 1 without LaserScan; its topics are /odom \(nav_msg",
        ),
        opened_log(tmp_path / "a.bag"),
    ):
        pass


@pytest.mark.parametrize("named", ["", "metadata.yaml", "renamed.mcap"])
def test_a_file_that_was_renamed_in_its_folder_is_read_by_itself(
    tmp_path: Path, named: str
) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        writer.odometry(1.0, ORIGIN)
        writer.scan(1.0, [1.0, 1.0])
    (tmp_path / "bag" / "bag.mcap").rename(tmp_path / "bag" / "renamed.mcap")
    assert len(scans(tmp_path / "bag" / named)) == 1


def records(mcap: bytes) -> Iterator[bytes]:
    """Yield the records of an MCAP file, whose first byte is their kind."""
    at = 8
    while at < len(mcap) - 8:
        after = at + 9 + int.from_bytes(mcap[at + 1 : at + 9], "little")
        yield mcap[at:after]
        at = after


@pytest.mark.parametrize("lost", [1, 30_000])
def test_a_recording_that_was_cut_off_is_read_up_to_there(tmp_path: Path, lost: int) -> None:
    with BagWriter(tmp_path / "bag", "mcap") as writer:
        for number in range(300):
            writer.odometry(1.0 + number, Pose2(0.1 * number))
            writer.scan(1.5 + number, [1.0] * 1000, step=0.001, at=2.5 - number % 2 + number)
    file = tmp_path / "bag" / "bag.mcap"
    (tmp_path / "bag" / "metadata.yaml").unlink()
    whole = list(records(file.read_bytes()))
    # recorders write schemas and channels in front of messages, too
    described, chunks = ([each for each in whole if each[0] in kinds] for kinds in ((3, 4), (6,)))
    cut = b"".join([b"\x89MCAP0\r\n", whole[0], *described, *chunks])
    file.write_bytes(cut[:-lost] if lost > 1 else cut)
    assert len(scans(tmp_path / "bag")) == pytest.approx(300 if lost == 1 else 215, abs=10)
    assert notes(file)[0] == "the end of the file is missing: read up to there"
    file.write_bytes(cut[:60])
    with pytest.raises(ConfigError, match=r"bag\.mcap: is an MCAP file without LaserScan; the end"):
        scans(file)


def test_damaged_messages_are_told(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "a.bag", ROS_1) as writer:
        writer.odometry(1.0, ORIGIN)
        writer.scan(1.0, [1.0, 1.0], frame="of a good scan")
        writer.scan(2.0, [1.0, 1.0], frame="of a bad one")
        writer.scan(3.0, [1.0, 1.0], step=100.0)
    whole = (tmp_path / "a.bag").read_bytes()
    frame = b"\x0c\0\0\0of a bad one"
    (tmp_path / "a.bag").write_bytes(whole.replace(frame, b"\xff" * len(frame)))
    assert notes(tmp_path / "a.bag")[-1] == "messages that are damaged and left out: 2"


@pytest.mark.parametrize("storage", [ROS_1, "sqlite3", "mcap"])
def test_a_damaged_bag_is_refused_or_read_as_far_as_it_goes(tmp_path: Path, storage: str) -> None:
    path = tmp_path / "bag"
    with BagWriter(path, storage) as writer:
        for number in range(20):
            writer.odometry(1.0 + number, Pose2(0.1 * number))
            writer.scan(1.0 + number, [1.0] * 90)
    file = path if storage == ROS_1 else next(iter({*path.iterdir()} - {path / "metadata.yaml"}))
    whole, random = file.read_bytes(), np.random.default_rng(1)
    for _ in range(60):
        damaged = bytearray(whole[: int(random.integers(16, len(whole) + 1))])
        for place in random.integers(16, len(damaged) + 1, 8).tolist():
            damaged[place - 1] = int(random.integers(256))
        file.write_bytes(damaged)
        with suppress(ConfigError):
            scans(path)
