"""Tables of a log have all its numbers, and no cell that a spreadsheet would obey."""

import csv
from datetime import datetime
from math import isnan
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.log.columns import TableColumn
from pioneer3.log.csv_file import CsvFile
from pioneer3.log.output import new_output
from pioneer3.log.reader import open_log
from pioneer3.log.tables import TableKind, write_tables
from pioneer3.log.topics import LogEvent
from pioneer3.runtime.recording import CommandGiven
from tests.logs import ANGLES, BEGAN, READINGS, SECOND, drive, snapshot, write_log

Rows = list[dict[str, str]]


def rows_of(path: Path) -> Rows:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def number(text: str) -> float | None:
    return float(text) if text else None


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return write_log(
        tmp_path / "a.mcap", [*drive(lasers=["laser"]), (1.0, "wire/robot/in", b"\xfa\xfb")]
    )


def test_a_table_of_each_topic_has_the_numbers_of_its_messages(log: Path, tmp_path: Path) -> None:
    shares: list[float] = []
    counts = write_tables(open_log(log), tmp_path / "out", TableKind.CSV, tell=shares.append)
    assert {name: counts[name] for name in ("snapshot.csv", "scan-laser.csv", "command.csv")} == {
        "snapshot.csv": 31,
        "scan-laser.csv": 31,
        "command.csv": 4,
    }
    assert {path.name for path in (tmp_path / "out").iterdir()} == counts.keys()
    assert shares == sorted(shares)
    assert shares[-1] > 0.9
    for row, second in zip(rows_of(tmp_path / "out/snapshot.csv"), range(31), strict=True):
        at = 0.02 + second / 10
        known = snapshot(at)
        pose = known.odometry.robot_in_odom
        assert float(row["odometry.robot_in_odom.x [m]"]) == pose.x
        assert float(row["odometry.robot_in_odom.theta [rad]"]) == pose.theta
        assert float(row["stamp [s]"]) == known.stamp
        assert [row[f"sonar.ranges.{each} [m]"] for each in range(4)] == [
            "0.5",
            "inf",
            "nan",
            "2.25",
        ]
        assert (row["motors.enabled"], row["sonar.fresh"]) == ("true", "[0,1,3]")
        assert (row["battery.voltage [V]"], row["inputs.compass [rad]"]) == ("12.3", "")
        assert datetime.fromisoformat(row["time"]).timestamp() == pytest.approx(
            BEGAN / SECOND + at, abs=1e-6
        )
        assert float(row["elapsed [s]"]) == pytest.approx(at - 0.01, abs=1e-6)
    scans = rows_of(tmp_path / "out/scan-laser.csv")
    ranges = [float(scans[-1][f"ranges.{each} [m]"]) for each in range(5)]
    assert str(ranges) == str([*READINGS])
    angles = rows_of(tmp_path / "out/scan-laser-angles.csv")
    assert [[float(row[f"angles.{each} [rad]"]) for each in range(5)] for row in angles] == [
        [*ANGLES]
    ]
    assert rows_of(tmp_path / "out/wire-robot-in.csv")[0]["bytes"] == "fa fb"


def test_parquet_has_the_same_rows_with_types(log: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    names = write_tables(open_log(log), tmp_path / "csv", TableKind.CSV).keys()
    write_tables(open_log(log), tmp_path / "parquet", TableKind.PARQUET)
    for name in names:
        table = parquet.read_table(tmp_path / "parquet" / name.replace(".csv", ".parquet"))
        rows, same = rows_of(tmp_path / "csv" / name), table.to_pylist()
        assert [*rows[0]] == table.column_names
        assert len(rows) == len(same)
        for row, other in zip(rows, same, strict=True):
            for column, value in other.items():
                if isinstance(value, float) and isnan(value):
                    assert row[column] == "nan"
                elif isinstance(value, float | int) and not isinstance(value, bool):
                    assert float(row[column]) == value
                elif isinstance(value, str):
                    assert row[column] == value
    table = parquet.read_table(tmp_path / "parquet/snapshot.parquet")
    kinds = dict(zip(table.column_names, map(str, table.schema.types), strict=True))
    assert kinds["time"] == "timestamp[ns, tz=UTC]"
    assert kinds["motors.enabled"] == "bool"
    assert kinds["sequence"] == "int64"
    assert kinds["odometry.twist.v [m/s]"] == "double"
    assert table["time"][0].value == BEGAN + round(0.02 * SECOND)


def test_without_pyarrow_a_command_brings_it(
    log: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(ConfigError, match=r"needs pyarrow; run: .* pip install .*pyarrow"):
        write_tables(open_log(log), tmp_path / "out", TableKind.PARQUET)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)", "\tx", "\r=1", "\n=1"])
def test_no_text_of_others_is_a_formula(text: str, tmp_path: Path) -> None:
    given = CommandGiven(text, f'drive"{text}')
    path = write_log(tmp_path / "a.mcap", [(0.0, "command", given)])
    write_tables(open_log(path), tmp_path / "out", TableKind.CSV)
    with CsvFile(tmp_path / "out/head.csv", [TableColumn(text, str)]) as made:
        made.add(BEGAN, 0.0, [text])
    for file in (tmp_path / "out").iterdir():
        with file.open(encoding="utf-8", newline="") as opened:
            for row in csv.reader(opened):
                assert not any(
                    cell.startswith(("=", "+", "-", "@", "\t", "\r", "\n")) for cell in row
                )
    assert rows_of(tmp_path / "out/command.csv")[0]["by"] == f"'{text}"


def test_names_of_files_are_those_of_no_other_folder_and_of_no_two_topics(tmp_path: Path) -> None:
    topics = ["../../etc/passwd", "a/b", "a-b", "A/b", "a\x00b", "/", "..", "é/ü", "x" * 300, "CON"]
    path = write_log(
        tmp_path / "a.mcap", [(0.0, topic, LogEvent("link", topic)) for topic in topics]
    )
    counts = write_tables(open_log(path), tmp_path / "out", TableKind.CSV)
    found = sorted(each.name for each in (tmp_path / "out").iterdir())
    assert found == sorted(counts)
    assert len({name.lower() for name in found}) == len(topics)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.mcap", "out"]


def test_a_log_without_messages_has_no_tables(tmp_path: Path) -> None:
    path = write_log(tmp_path / "a.mcap", [])
    with pytest.raises(ConfigError, match="no messages"):
        write_tables(open_log(path), tmp_path / "out", TableKind.CSV)
    assert not (tmp_path / "out").exists()


def test_a_log_that_was_cut_off_has_tables_of_all_before(tmp_path: Path) -> None:
    path = write_log(tmp_path / "a.mcap", drive(), ended=False)
    counts = write_tables(open_log(path), tmp_path / "out", TableKind.CSV)
    assert counts["snapshot.csv"] == 31


def test_an_output_is_whole_or_not_there(tmp_path: Path) -> None:
    def fail(made: Path) -> None:
        made.mkdir()
        (made / "part").write_text("half")
        raise ValueError("damaged")

    with pytest.raises(ValueError, match="damaged"), new_output(tmp_path / "out") as made:
        fail(made)
    assert [*tmp_path.iterdir()] == []
    with new_output(tmp_path / "file") as made:
        made.write_text("whole")
        assert not (tmp_path / "file").exists()
    assert (tmp_path / "file").read_text() == "whole"
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o600
    assert [each.name for each in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize("kind", ["file", "folder", "link"])
def test_an_output_takes_the_place_of_nothing(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "out"
    if kind == "folder":
        path.mkdir()
    elif kind == "link":
        path.symlink_to("nowhere")
    else:
        path.write_text("mine")
    with pytest.raises(ConfigError, match="there already"), new_output(path):
        raise AssertionError
    path.rmdir() if kind == "folder" else path.unlink()

    def meet(made: Path) -> None:
        made.write_text("whole")
        path.write_text("mine")  # by somebody else meanwhile

    with pytest.raises(ConfigError, match="File exists"), new_output(path) as made:
        meet(made)
    assert path.read_text() == "mine"
    assert [each.name for each in tmp_path.iterdir()] == ["out"]


def test_an_output_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    path = tmp_path / "no folder/out"
    with pytest.raises(ConfigError, match="cannot be written: No such file"), new_output(path):
        raise AssertionError
