"""`pioneer3 log convert` makes what its option or the end of the new name says."""

from pathlib import Path

import pytest

from pioneer3.cli.log_convert import convert, kind_of
from pioneer3.errors import ConfigError
from tests.logs import drive, write_log


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("drive.bag", "rosbag1"),
        ("DRIVE.BAG", "rosbag1"),
        ("drive-csv", "csv"),
        ("drive.csv", "csv"),
        ("csv", "csv"),
        ("a/drive_rosbag2", "rosbag2"),
        ("drive.parquet", "parquet"),
    ],
)
def test_the_end_of_the_name_says_the_kind(name: str, kind: str) -> None:
    assert kind_of(Path(name)) == kind


@pytest.mark.parametrize("name", ["drive", "drive.mcap", "bag", "csv/drive", "mycsv", "rosbag3"])
def test_a_name_that_says_nothing_needs_the_option(name: str) -> None:
    with pytest.raises(ConfigError, match="does not say what to make: add --to"):
        kind_of(Path(name))


def test_each_kind_is_made_and_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = str(write_log(tmp_path / "a.mcap", drive(1)))
    assert convert(log, output=tmp_path / "bag", to="rosbag2") == 0
    assert {each.name for each in (tmp_path / "bag").iterdir()} == {"bag.mcap", "metadata.yaml"}
    assert convert(log, output=tmp_path / "drive.bag", profile="standard") == 0
    assert convert(log, output=tmp_path / "drive-csv") == 0
    assert (tmp_path / "drive-csv/snapshot.csv").exists()
    lines = capsys.readouterr().out.splitlines()
    assert [line.rpartition("/")[2].partition(":")[0] for line in lines] == [
        "bag",
        "drive.bag",
        "drive-csv",
    ]
    with pytest.raises(ConfigError, match="there already"):
        convert(log, output=tmp_path / "drive.bag")
