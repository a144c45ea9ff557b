"""Logs are known by their content, and other files are named for what they are."""

import bz2
import gzip
import lzma
import re
import zipfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.nav.logged import LoggedScan
from pioneer3.navigation.log_files import LONGEST_LINE, is_recording, opened_log
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.state import Scan

CASES = Path(__file__).resolve().parents[4] / "shared" / "cases"
FLASER = "FLASER 2 1.0 2.0 0 0 0 0 0 0 1 host 1\n"
SCAN_LOG = "version: 2\nsick1conf: -90 90 3\nrobot: 0 0 0\nsick1: 1000 1000 1000 1000\n"


def scans(path: Path, given: Mounting | None = None) -> list[Scan]:
    with opened_log(path, given) as log:
        entries = list(log.entries(log.sources.lasers[0], log.sources.odometry[0]))
        assert log.share == 1.0
    return [entry.scan for entry in entries if isinstance(entry, LoggedScan)]


def refused(path: Path, reason: str) -> None:
    with pytest.raises(ConfigError, match=reason), opened_log(path):
        pass


def picture(kind: str) -> bytes:
    file = BytesIO()
    Image.new("RGB", (2, 2)).save(file, kind)
    return file.getvalue()


def archive() -> bytes:
    file = BytesIO()
    with zipfile.ZipFile(file, "w") as archived:
        archived.writestr("a.log", FLASER)
    return file.getvalue()


@pytest.mark.parametrize("pack", [bytes, gzip.compress, bz2.compress, lzma.compress])
@pytest.mark.parametrize(
    ("text", "name"),
    [
        (f"# a comment\n{FLASER}", "a log of CARMEN"),
        (f"\ufeffLaserOdometryLog\r\n{SCAN_LOG}", "a scan log of ARIA"),
        (SCAN_LOG, "a scan log of ARIA"),
    ],
)
def test_a_text_is_known_by_its_content_packed_or_not(
    tmp_path: Path, pack: Callable[[bytes], bytes], text: str, name: str
) -> None:
    path = tmp_path / "log.dat"
    path.write_bytes(pack(text.encode()))
    with opened_log(path) as log:
        assert log.name == name
    assert len(scans(path)) == 1
    assert not is_recording(path)


@pytest.mark.parametrize(
    ("content", "name"),
    [
        (b"", "is empty"),
        (picture("PNG"), "a picture"),
        (picture("JPEG"), "a picture"),
        (picture("BMP"), "a picture"),
        (picture("TIFF"), "a picture"),
        (picture("PPM"), "a picture"),
        (b"2D-Map\nLineMinPos: 0 0\n", "a map of ARIA already"),
        (b"# comment\nimage: lab.pgm\nresolution: 0.05\n", "the YAML of a map with its picture"),
        (b'include "pioneer.inc"\nfloorplan\n(\n  name "lab"\n)\n', "a world of Stage"),
        (b"<?xml version='1.0'?><sdf version='1.6'>", "XML, such as a world or a launch file"),
        (b"<!DOCTYPE html><html>", "a web page: the file was not what was downloaded"),
        (archive(), "an archive: unpack it first"),
        (b"\x7fELF\x02", "a program"),
        (b"%PDF-1.4", "a document"),
        (b"version https://git-lfs.github.com/spec/v1\noid", "a pointer of Git LFS"),
        (b"#ROSRECORD V1.2\n", "a rosbag of a format before 2.0"),
        (gzip.compress(b"#ROSBAG V2.0\nE", mtime=0), "a rosbag that is packed: unpack it first"),
        (b"\x89MCAP0\r\n\1\x19\0\0\0\0\0\0\0\4\0\0\0ros1", "an MCAP file that is not of ROS 2"),
        (b"## Player version 3.0.2\n", "a log of Player"),
        (b"\xd4\xc3\xb2\xa1\2\0", "a network capture"),
        (b"stamp,x,y\n1,2,3\n", "a text that is no log of scans: it begins with 'stamp,x,y'"),
        (b"\0\1\2\3", "of a format that is not known"),
        (b"ODOM 0 0 0 0 0 0 1 h 1\n", ""),
    ],
)
def test_other_files_are_named(tmp_path: Path, content: bytes, name: str) -> None:
    path = tmp_path / "a.log"
    path.write_bytes(content)
    if not name:
        with opened_log(path) as log:
            assert not log.sources.lasers
        return
    with pytest.raises(ConfigError, match=f"{path.name}: is .*") as error, opened_log(path):
        pass
    assert name in str(error.value)
    assert "read are logs of CARMEN, scan logs of ARIA (.2d), rosbags" in str(error.value)


def test_a_folder_needs_a_bag_and_a_device_is_no_log(tmp_path: Path) -> None:
    refused(tmp_path, r"without metadata.yaml, with no rosbag in it")
    refused(Path("/dev/zero"), "/dev/zero: is not a file")
    with pytest.raises(ConfigError, match="cannot be read: No such file"):
        is_recording(tmp_path / "none")


@pytest.mark.parametrize(
    ("text", "note"),
    [
        (f"{FLASER}FLASER 2 1.0 x 0 0 0 0 0 0 1 host 1\nODOM 1\n", "line 2 .*, and 1 more"),
        (f"{SCAN_LOG}robot: 0 nan 0\n", "line 5 is damaged and left out$"),
    ],
)
def test_damaged_lines_are_told(tmp_path: Path, text: str, note: str) -> None:
    path = tmp_path / "a.log"
    path.write_text(text)
    with opened_log(path) as log:
        list(log.entries(log.sources.lasers[0], log.sources.odometry[0]))
        (told,) = log.notes
    assert re.match(note, told)


def test_a_packed_text_that_is_cut_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.log.gz"
    path.write_bytes(gzip.compress((FLASER * 5000).encode() + bytes(range(256)) * 999)[:-2000])
    with pytest.raises(ConfigError, match=r"a\.log\.gz: cannot be read"):
        scans(path)


def test_a_line_without_an_end_is_read_in_parts(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text(f"{FLASER}{'1' * (LONGEST_LINE + 1)}\n{FLASER}")
    assert len(scans(path)) == 2


def test_the_place_of_a_laser_can_be_told(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text(FLASER)
    (scan,) = scans(path, Mounting(sensor_in_robot=Pose2(0.1, 0.2), upside_down=True))
    assert scan.sensor_in_robot == Pose2(0.1, 0.2)
    assert scan.ranges == (2.0, 1.0)


@pytest.mark.parametrize(
    ("file", "count"),
    [
        ("carmen-robotlaser/robotlaser.log", 60),
        ("carmen-robotlaser/rawlaser.log", 60),
        ("scan-log-2d/old.2d", 200),
        ("scan-log-2d/new.2d", 200),
    ],
)
def test_logs_of_labs_are_read(file: str, count: int) -> None:
    if not CASES.is_dir():
        pytest.skip("the cases are not here")
    assert len(scans(CASES / file)) == count


def test_a_bag_with_nothing_in_it_is_named() -> None:
    path = CASES / "rosbag/x.bag"
    if not path.exists():
        pytest.skip("the cases are not here")
    refused(path, r"x\.bag: is a rosbag of ROS 1 that cannot be read: .*rosbag reindex")
