"""`pioneer3 fleet push` and `pull`: a file arrives whole, or what was there stays."""

import hashlib
import subprocess
import time
from pathlib import Path

import pytest

from tests.fleet.lab import SMALL, Lab

pytestmark = pytest.mark.realtime


def test_files_arrive_with_their_modes_and_nothing_else_is_left(lab: Lab) -> None:
    home = lab.operator.home
    data = bytes(range(256)) * 4000
    (home / "start me.sh").write_bytes(data)
    (home / "start me.sh").chmod(0o750)
    (home / "package/launch").mkdir(parents=True)
    (home / "package/launch/demo.launch").write_text("<launch/>")
    (home / "package/setup").write_text("x")
    done = lab.operator.p3("fleet", "push", "start me.sh", "package", "work/")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("3 files, 1.02 MB") == 3
    for robot in lab.robots:
        work = robot.user_home / "work"
        assert (work / "start me.sh").read_bytes() == data
        assert (work / "start me.sh").stat().st_mode & 0o777 == 0o750
        assert (work / "start me.sh").stat().st_uid == 5400
        found = {str(path.relative_to(work)) for path in work.rglob("*") if path.is_file()}
        assert found == {"start me.sh", "package/launch/demo.launch", "package/setup"}


def test_one_file_takes_the_name_or_goes_into_the_folder(lab: Lab) -> None:
    (lab.operator.home / "lab.map").write_text("new")
    (lab.robots[0].user_home / "maps").mkdir(mode=0o777)
    (lab.robots[0].user_home / "maps").chmod(0o777)
    done = lab.operator.p3("fleet", "push", "--on", "front", "lab.map", "maps")
    assert done.returncode == 0, done.stderr
    assert (lab.robots[0].user_home / "maps/lab.map").read_text() == "new"
    assert (lab.robots[1].user_home / "maps").read_text() == "new"


def test_a_full_disk_leaves_the_old_file(lab: Lab) -> None:
    (lab.operator.home / "big").write_bytes(b"new" * 200_000)
    small = lab.robots[1].root / SMALL.lstrip("/")
    (small / "big").write_text("old")
    for robot in (lab.robots[0], lab.robots[2]):
        robot.sh("umount /opt/small && chmod 777 /opt/small")
    done = lab.operator.p3("fleet", "push", "big", f"{SMALL}/big")
    words = " ".join(done.stderr.split())
    assert "the disk there is full" in words
    assert "1 of 3 failed: p3at-2" in words
    assert done.returncode == 1
    assert [path.name for path in small.iterdir()] == ["big"]
    assert (small / "big").read_text() == "old"


def test_a_folder_that_is_not_ours_and_a_file_that_is_not_here_are_told(lab: Lab) -> None:
    (lab.operator.home / "file").write_text("x")
    done = lab.operator.p3("fleet", "push", "--on", "p3at-1", "file", "/opt/file")
    assert "/opt/file: this user may not write there" in done.stderr
    assert done.returncode == 1
    missing = lab.operator.p3("fleet", "push", "nothing", "file", "there/")
    assert "nothing: there is no such file here" in missing.stderr
    assert missing.returncode == 2


def test_an_interrupted_copy_leaves_the_old_file_and_no_part_of_the_new(lab: Lab) -> None:
    (lab.operator.home / "big").write_bytes(b"new" * 20_000_000)
    for robot in lab.robots:
        (robot.user_home / "big").write_text("old")
        robot.cable.delay = 0.05
    words = ["fleet", "push", "big", "big", "--timeout", "5"]
    with subprocess.Popen(
        lab.operator.command(*words), env=lab.operator.environment, stderr=subprocess.DEVNULL
    ) as process:
        end = time.monotonic() + 30
        while not all(any(robot.user_home.glob(".big.*")) for robot in lab.robots):
            assert time.monotonic() < end
            time.sleep(0.02)
        process.terminate()
        assert process.wait(20) == 143
    for robot in lab.robots:
        assert (robot.user_home / "big").read_text() == "old"
        assert not [path.name for path in robot.user_home.glob(".big.*")]


def test_pulled_files_go_to_a_folder_for_each_robot(lab: Lab) -> None:
    for robot in lab.robots:
        runs = robot.user_home / "runs"
        (runs / "deep").mkdir(parents=True)
        (runs / "a.mcap").write_text(robot.name)
        (runs / "deep/b.mcap").write_text("b")
        (runs / "a.mcap").chmod(0o640)
        (runs / "a.mcap").chmod(0o644)
    done = lab.operator.p3("fleet", "pull", "runs/*.mcap", "runs/deep", "--to", "monday")
    assert done.returncode == 0, done.stderr
    monday = lab.operator.home / "monday"
    assert sorted(str(path.relative_to(monday)) for path in monday.rglob("*.mcap")) == [
        f"p3at-{number}/{name}" for number in (1, 2, 3) for name in ("a.mcap", "deep/b.mcap")
    ]
    assert (monday / "p3at-2/a.mcap").read_text() == "p3at-2"
    none = lab.operator.p3("fleet", "pull", "--on", "front", "runs/*.bag")
    assert none.stderr.count("runs/*.bag: no such file there") == 2
    assert none.returncode == 1


def test_a_large_file_comes_back_as_it_was_over_a_bad_network(lab: Lab, tmp_path: Path) -> None:
    data = hashlib.sha256(b"seed").digest() * 20_000
    (lab.operator.home / "file").write_bytes(data)
    (lab.robots[1].user_home / ".bashrc").write_text("echo Welcome to the lab; cd /\n")
    lab.robots[0].cable.loss = 0.02
    lab.robots[0].cable.delay = 0.02
    assert lab.operator.p3("fleet", "push", "file", "file").returncode == 0
    assert lab.operator.p3("fleet", "pull", "file").returncode == 0
    for robot in lab.robots:
        assert (lab.operator.home / robot.name / "file").read_bytes() == data


@pytest.mark.parametrize(
    ("truth", "lie"),
    [("evil.txt", "/opt/evi"), ("evil-file", "../../../"), ("evil.d", "/../.."), ("runs", "/../")],
)
def test_a_robot_that_lies_about_names_writes_nothing_elsewhere(
    lab: Lab, truth: str, lie: str
) -> None:
    robot = lab.robots[0]
    (robot.user_home / "runs" / "evil.d").mkdir(parents=True)
    for name in ("runs/evil.txt", "runs/evil-file", "runs/evil.d/deep"):
        (robot.user_home / name).write_text("evil")
    robot.lie(truth, lie)
    before = {*lab.operator.home.rglob("*")}
    done = lab.operator.p3("fleet", "pull", "--on", robot.name, "runs", "--to", "here")
    assert done.returncode == 1
    assert "nothing is copied" in " ".join(done.stderr.split())
    assert {*lab.operator.home.rglob("*")} == before


def test_a_whole_disk_is_not_pulled(lab: Lab) -> None:
    done = lab.operator.p3("fleet", "pull", "--on", "p3at-1", "/")
    assert done.returncode == 1
    assert "name a folder" in done.stderr
