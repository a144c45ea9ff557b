"""No name, address or serial number of a log is left in its copy without them; numbers are."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given as drawn
from hypothesis import strategies as st
from mcap.reader import make_reader

import pioneer3
from pioneer3.analysis.anonymous import FORMS, Names, _command, write_anonymous
from pioneer3.analysis.anonymous_bytes import GIVEN_UP, LinkScrubber
from pioneer3.arcos import packet, reports
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.log.reader import RunLog
from pioneer3.log.topics import EVENT, LogEvent, LogTopic
from pioneer3.maps import LineMap, MapObject
from pioneer3.maps.write import aria_text
from pioneer3.models import RobotModel, load_model
from pioneer3.nav.places import Destination
from pioneer3.navigation.goals import GoalChanged
from pioneer3.navigation.recording import MapUsed
from pioneer3.robot.explain import DISCONNECTED, Reason, ReasonKind
from pioneer3.runtime.recording import CommandGiven, StandsBecause
from pioneer3.state import Scan
from tests.unit.analysis.support import driven, given, scan, topic, write_log

SECOND = 10**9
MAC = "aa:bb:cc:dd:ee:ff"
SECRETS = (
    *("rosalind", "SN-20457", "ann.lee", "Smith", "Beamline", "lab-17", "10.4.7.21", "4711"),
    *("/home/ann", "thesis", MAC, "basement", "wonderland", "Zoe", "Bo Li", "nas7", "p3-rosa"),
    *("Rosa's", "WheelchairStop"),
)
IDENTITY = reports.SyncIdentity("rosalind", "Pioneer", "p3at-sh")
CONFIG = reports.Config(
    family="Pioneer",
    model="p3at-sh",
    serial_number="SN-20457",
    four_motors=1,
    rotation_top_deg_s=360,
    speed_top_mm_s=2200,
    rotation_accel_top_deg_s2=600,
    accel_top_mm_s2=4000,
    pwm_max_raw=7,
    name="rosalind",
)
TEXT = reports.FirmwareText("hello Smith")


def frame(report: object) -> bytes:
    return packet.encode(reports.to_payload(report))  # type: ignore[arg-type]


SIP = frame(reports.Encoders(-4711, 20457))
WIRE = b"wonderland" + b"".join(map(frame, (IDENTITY, CONFIG, TEXT))) + SIP


def a_log(path: Path, prefix: str = "") -> Path:
    """Write a log with a name in each place that has names."""
    goal = GoalChanged(
        number=1, by="ann.lee", places=(Destination(x=1.0, y=2.0, name="Smith's office"),),
        status="accepted", reason="ann.lee said so", speed=None, rounds=1.0,
    )  # fmt: skip
    places = tuple(
        MapObject(kind=kind, name="Beamline", pose=Pose2(1.0, 2.0, 0.0))
        for kind in ("Goal", "WheelchairStop")
    )
    line_map = LineMap(name="basement", walls=np.array([[0.0, 0.0, 5.0, 0.0]]), objects=places)
    own = replace(load_model("p3at-sh"), name="p3-rosa", title="Rosa's robot")
    used = MapUsed(
        name="basement", file="/home/ann/basement.map", sha256="4711", text=aria_text(line_map)
    )
    texts = {
        "program": {"command": "/home/ann/thesis.py --port tcp://lab-17:8101 --speed 0.3"},
        f"{prefix}robot": {
            "name": "rosalind",
            "model": "p3at-sh",
            "url": "tcp://lab-17:8101",
            "configuration": msgspec.json.encode(CONFIG).decode(),
        },
        "end": {"why": "OSError: wonderland: 10.4.7.21:8101 and\n/home/ann are gone"},
    }
    lost = DISCONNECTED.about(": lab-17")
    stopped = Reason(ReasonKind.STOPPED, "Zoe stopped the robot")
    messages = [
        *driven(2.0, prefix),
        (0.1, LogTopic(f"wire/{prefix}robot/in", bytes), WIRE[:17]),
        (0.2, LogTopic(f"wire/{prefix}robot/in", bytes), WIRE[17:]),
        (0.2, LogTopic(f"wire/{prefix}laser/in", bytes), b"SERI:SN-20457"),
        (0.3, topic(f"{prefix}goal", GoalChanged), goal),
        (0.4, topic(f"{prefix}map", MapUsed), used),
        (0.5, topic(f"{prefix}command", CommandGiven), given("ann.lee", "drive to Beamline", 0.3)),
        (0.6, topic(f"{prefix}standing", StandsBecause), StandsBecause(lost)),
        (0.7, EVENT, LogEvent("link", f"{prefix}robot: rosalind on tcp://lab-17 ({MAC})")),
        (0.7, EVENT, LogEvent("link", "laser: lost: tcp://nas7:1: nas7 is away; see a/thesis/a.p")),
        (0.7, topic(f"{prefix}model", RobotModel), own),
        (0.8, EVENT, LogEvent("page", "Zoe came, a driver")),
        (0.8, EVENT, LogEvent("page", "Zoe is called Bo Li now")),
        (0.8, EVENT, LogEvent("page", "wonderland")),
        (0.8, topic(f"{prefix}standing", StandsBecause), StandsBecause(stopped)),
        (0.8, EVENT, LogEvent("notice", "Bo Li took over")),
        (0.9, topic(f"{prefix}scan/laser", Scan, steady="angles"), scan(0.9)),
        (1.0, topic("notes", LogEvent), LogEvent("note", "wonderland")),
    ]  # fmt: skip
    return write_log(path / "a.mcap", messages, robots={}, texts=texts)


@pytest.mark.parametrize("prefix", ["", "rosalind/"])
def test_no_secret_is_in_any_byte_of_the_copy(tmp_path: Path, prefix: str) -> None:
    log = pioneer3.log.open(a_log(tmp_path, prefix))
    before = unpacked(log.path)
    assert [each for each in SECRETS if each.encode() not in before] == []
    copy = tmp_path / "copy.mcap"
    write_anonymous(log, copy)
    assert [each for each in SECRETS if each.encode() in unpacked(copy)] == []
    kept = pioneer3.log.open(copy)
    assert kept.topics() == log.topics()
    for name in ("odometry", "battery", "sonar", "scan"):
        assert kept.array(name).tobytes() == log.array(name).tobytes()
    assert kept.info().command == "python --port *** --speed 0.3"
    assert kept.info().end == "OSError"
    ((_, used),) = kept.messages("map")
    assert used.line_map.walls.tolist() == [[0.0, 0.0, 5.0, 0.0]]
    assert copy.stat().st_mode & 0o777 == 0o600


def unpacked(path: Path) -> bytes:
    """Return all that a file says, as it is when it is unpacked."""
    log = RunLog(path)
    parts = [repr(log.info().texts).encode(), path.read_bytes()]
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            parts += [message.data, repr(channel).encode(), repr(schema).encode()]
    parts += [each.data for each in log.messages()]
    return b"\n".join(parts)


def without_names(data: bytes, *, is_command: bool, size: int = 7) -> tuple[bytes, set[str]]:
    """Return bytes without names that came in pieces of a size, and the names."""
    scrubber = LinkScrubber(is_command=is_command)
    pieces = [data[at : at + size] for at in range(0, len(data), size)]
    for number, piece in enumerate(pieces):
        scrubber.feed(number * SECOND, piece)
    scrubber.end()
    assert [*map(len, scrubber.ready)] == [*map(len, pieces)]
    return b"".join(scrubber.ready), scrubber.names


def test_a_frame_that_comes_in_pieces_waits_until_it_is_whole_or_the_line_is_silent() -> None:
    scrubber, whole = LinkScrubber(is_command=False), frame(IDENTITY)
    scrubber.feed(0, whole[:9])
    scrubber.feed(SECOND, whole[9:-1])
    assert not scrubber.ready
    scrubber.feed(2 * SECOND, whole[-1:] + b"ab")
    first, *rest = scrubber.ready
    assert first == whole[:4] + b"xxxxx"
    assert b"".join(rest)[-2:] == bytes(2)
    scrubber.ready.clear()
    scrubber.feed(3 * SECOND, whole[:9])
    scrubber.feed(3 * SECOND + GIVEN_UP + 1, whole[9:])
    assert b"".join(scrubber.ready) == bytes(len(whole))


def test_frames_stay_valid_and_as_long_as_before() -> None:
    clean, names = without_names(WIRE, is_command=False)
    assert names == {"rosalind", "SN-20457"}
    assert len(clean) == len(WIRE)
    payloads = packet.PacketReader().feed(clean)
    identity, config, text, ticks = map(reports.from_payload, payloads)
    assert identity == reports.SyncIdentity("x" * 8, "Pioneer", "p3at-sh")
    assert isinstance(config, reports.Config)
    assert (config.name, config.serial_number, config.pwm_max_raw) == ("x" * 8, "x" * 8, 7)
    assert reports.to_payload(text)[0] == reports.FirmwareText.ID
    assert b"Smith" not in clean
    assert ticks == reports.Encoders(-4711, 20457)


def test_texts_in_commands_are_left_out_and_numbers_stay() -> None:
    number, words = bytes([11, 0x3B, 200, 0]), b"\x2a\x2b\x05Smith"
    data = packet.encode(number) + packet.encode(words) + packet.encode(b"\x00")
    clean, _ = without_names(data, is_command=True)
    assert packet.PacketReader().feed(clean) == [number, b"\x2a\x2b\x05" + bytes(5), b"\x00"]


@drawn(st.lists(st.binary(max_size=30) | st.sampled_from([SIP, frame(IDENTITY), b"\xfa\xfb"])))
def test_any_bytes_stay_as_long_and_tell_no_name(pieces: list[bytes]) -> None:
    data = b"".join(pieces)
    for is_command in (False, True):
        clean, _ = without_names(data, is_command=is_command)
        assert clean == without_names(data, is_command=is_command, size=1000)[0]
        assert len(clean) == len(data)
        assert b"rosalind" not in clean


@drawn(st.text(alphabet="ac1A:/@.\\~ ,'_-°\n", max_size=60) | st.text(max_size=20))
def test_a_form_is_found_in_its_word_as_in_the_whole_text(text: str) -> None:
    whole = text
    for form, alias in FORMS:
        whole = form.sub(alias, whole)
    assert Names().hidden(text) == whole


@pytest.mark.parametrize(
    ("line", "kept"),
    [
        ("pioneer3 goto kitchen --map=lab.map -n 2", "pioneer3 goto *** --map=*** -n 2"),
        ("pioneer3 lab.toml", "pioneer3 ***"),
        ("thesis.py ann 0.3m/s", "python *** 0.3m/s"),
        ("", "python"),
    ],
)
def test_of_a_command_line_commands_options_and_numbers_stay(line: str, kept: str) -> None:
    assert _command(line) == kept


def test_words_that_are_no_names_stay() -> None:
    names = Names()
    names.add("place", ["Al", "Lab"])
    for text in (
        "0.29 m/s: follow way, 0.17 m to go; turns left at 21°/s: follow way",
        "Almost: 12:30:45 is at 3/4 of -55 deg, robot: connected: (Pioneer 3-AT)",
        "limiter sonar: takes 0.30 m/s",
    ):
        assert names.hidden(text) == text
    assert names.hidden("to Al, in Lab2") == "to place-1, in place-22"


def test_names_that_are_parts_of_words_and_numbers_leave_these_as_they_are() -> None:
    names = Names()
    names.add("user", ["ted", "Ed", "nor"])
    names.add("place", ["101", "1", "open", "start"])
    for text in ("accepted: 0.101 m, 1.1 s", "normal", "10101", "robot: open: ", "start", "x1"):
        assert names.hidden(text) == text
    assert names.hidden("ted's goal 101, nor_2; Ed") == "user-3's goal place-5, user-2_2; user-1"


def test_the_status_of_a_goal_is_no_name(tmp_path: Path) -> None:
    goal = GoalChanged(
        number=1, by="accepted", places=(), status="accepted", reason="", speed=None, rounds=1.0
    )
    messages = [*driven(1.0), (0.5, topic("goal", GoalChanged), goal)]
    write_anonymous(pioneer3.log.open(write_log(tmp_path / "a.mcap", messages)), tmp_path / "b")
    ((_, kept),) = pioneer3.log.open(tmp_path / "b").messages("goal")
    assert (kept.status, kept.by[:5]) == ("accepted", "user-")


def test_nothing_is_written_over_and_a_damaged_log_leaves_nothing(tmp_path: Path) -> None:
    log = pioneer3.log.open(a_log(tmp_path))
    copy = tmp_path / "copy.mcap"
    copy.write_text("mine")
    with pytest.raises(ConfigError, match=r"copy\.mcap: cannot be written: File exists"):
        write_anonymous(log, copy)
    assert copy.read_text() == "mine"
    copy.unlink()
    data = bytearray(log.path.read_bytes())
    for place, after in pairwise(range(200, len(data), 211)):
        broken = bytes(data[:place] + bytes(after - place) + data[after:])
        log.path.write_bytes(broken)
        try:
            write_anonymous(pioneer3.log.open(log.path), copy)
        except ConfigError:
            assert not copy.exists()
        copy.unlink(missing_ok=True)


def test_a_number_that_no_log_can_have_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, copy = a_log(tmp_path), tmp_path / "copy.mcap"

    def add(self: object, *_: object) -> None:
        msgspec.msgpack.encode(1 << 64)

    monkeypatch.setattr("pioneer3.log.mcap.McapFile.add", add)
    with pytest.raises(ConfigError, match="is damaged: can't serialize ints"):
        write_anonymous(pioneer3.log.open(path), copy)
    assert not copy.exists()
