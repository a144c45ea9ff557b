"""Programs that real lasers serve, re-implemented as mean as they are (cola.md 5)."""

from dataclasses import dataclass

import pytest

from pioneer3.lasers.cola.wire import ColaTelegramReader, encode
from pioneer3.models.lasers import LASERS
from tests.unit.lasers.cola_room import Program, Room, laser, program

ARIA_BUFFER = 10_000
LMS1XX_READ = 100


@dataclass
class AriaReader:
    """ARIA's way through a telegram: some fields it takes as words, some as eight characters."""

    text: str
    at: int = 0

    def word(self) -> str:
        end = self.text.find(" ", self.at)
        end = len(self.text) if end < 0 else end
        word, self.at = self.text[self.at : end], end + 1
        return word

    def number(self) -> int:
        return int(self.word() or "0", 16)

    def eight(self) -> int:
        word, self.at = self.text[self.at : self.at + 8], self.at + 9
        return int(word, 16)

    def channel(self) -> tuple[str, int, list[int]]:
        """Return content, count and values of one channel."""
        content = self.word()
        scale, offset, start = self.eight(), self.eight(), self.eight()
        assert scale in {0x3F800000, 0x40000000}
        assert offset == 0
        assert start
        step, count = self.number(), self.number()
        assert step in {2500, 3333, 5000, 10000}
        return content, count, [self.number() for _ in range(count)]


def aria_scan(text: str, *, lms5xx: bool = False) -> tuple[list[int | None], list[int]]:
    """Return ranges [mm], `None` where ARIA ignores them, and remissions."""
    assert len(text) + 2 <= ARIA_BUFFER
    reader = AriaReader(text)
    assert reader.word() == "sSN"
    assert reader.word() == "LMDscandata"
    for _ in range(14):  # up to the layer's angle
        reader.number()
    frequency, pulses = reader.number(), reader.number()
    assert frequency in {1500, 2500, 5000, 7500}
    assert pulses
    assert reader.number() == 0  # encoders
    ranges: list[int | None] = []
    for _ in range(reader.number()):
        content, _, values = reader.channel()
        if content == "DIST1" and lms5xx:
            ranges = [2 * value if value >= 15 else None for value in values]
        elif content == "DIST1":
            ranges = [value if value >= 50 else None for value in values]
    remissions: list[int] = []
    for _ in range(reader.number()):
        content, _, values = reader.channel()
        if content == "RSSI1":
            remissions = values
    return ranges, remissions


class AriaLaser(Program):
    """ARIA asks, drops other telegrams until the answer comes, and needs some answers exactly."""

    def want(self, request: str, needed: str) -> None:
        """Send `request`; its answer must begin with `needed`."""
        self.room.connection.receive(encode(request), self.room.now)
        name = needed.split(" ")[:2]
        texts = ColaTelegramReader().feed(self.room.connection.outgoing(self.room.now))
        answers = [text for text in texts if text.split(" ")[:2] == name]
        assert answers, texts
        assert f"{answers[0]} ".startswith(f"{needed} ")


def check_corridor(ranges: list[int | None], count: int, *, unit: int = 1) -> None:
    """Check that `ranges` are those of the room's corridor."""
    assert len(ranges) == count
    assert [i for i, reading in enumerate(ranges) if reading is None] == list(range(9, count, 10))
    assert all(abs(reading - (1000 + 2 * i)) < unit for i, reading in enumerate(ranges) if reading)


@pytest.mark.parametrize(("step", "frequency"), [(5000, 5000), (2500, 2500)])
def test_aria_with_an_lms1xx(step: int, frequency: int) -> None:
    aria = AriaLaser(Room(laser("lms-111")))
    aria.want("sMN SetAccessMode 3 F4724744", "sAN SetAccessMode 1")
    aria.want(
        f"sMN mLMPsetscancfg +{frequency} +1 +{step} -450000 +2250000", "sAN mLMPsetscancfg 0"
    )
    aria.want("sWN LMDscandatacfg 1 0 0 0 0 0 0 0 0 0 0 1", "sWA LMDscandatacfg")
    aria.want("sMN Run", "sAN Run 1")
    aria.want("sEN LMDscandata 1", "sEA LMDscandata 1")
    ranges, _ = aria_scan(aria.hear(0.05)[-1])
    check_corridor(ranges, 2_700_000 // step + 1)


def test_aria_asks_an_lms1xx_for_what_it_cannot_do() -> None:
    aria = AriaLaser(Room(laser("lms-111")))
    aria.want("sMN SetAccessMode 3 F4724744", "sAN SetAccessMode 1")
    aria.want("sMN mLMPsetscancfg +5000 +1 +2500 -450000 +2250000", "sAN mLMPsetscancfg 2")


def test_aria_reads_a_part_of_the_field_with_a_positive_start() -> None:
    aria = AriaLaser(Room(laser("lms-111")))
    aria.want("sMN SetAccessMode 3 F4724744", "sAN SetAccessMode 1")
    aria.want("sMN mLMPsetscancfg +5000 +1 +5000 +450000 +1350000", "sAN mLMPsetscancfg 0")
    aria.want("sMN Run", "sAN Run 1")
    aria.want("sEN LMDscandata 1", "sEA LMDscandata 1")
    ranges, _ = aria_scan(aria.hear(0.05)[-1])
    check_corridor(ranges, 181)


@pytest.mark.parametrize(("step", "interval"), [(10_000, 8), (5000, 4)])
def test_aria_with_an_lms5xx(step: int, interval: int) -> None:
    aria = AriaLaser(Room(laser("lms-511", spin_up=15.0)))
    aria.want("sMN SetAccessMode 3 F4724744", "sAN SetAccessMode 1")
    aria.want(f"sMN mLMPsetscancfg +7500 +1 +{step} -50000 +1850000", "sAN mLMPsetscancfg 0")
    aria.want("sRN LMPscancfg", f"sRA LMPscancfg 1D4C 1 {step:X} FFFF3CB0 1C3A90")
    aria.want("sMN LSPsetdatetime +2026 +11 +22 +5 +32 +23 0", "sAN LSPsetdatetime 1")
    aria.want(f"sWN LMDscandatacfg 1 0 1 0 0 0 0 0 0 0 1 +{interval}", "sWA LMDscandatacfg")
    aria.want(f"sWN LMPoutputRange 1 +{step} -50000 +1850000", "sWA LMPoutputRange")
    aria.want("sWN FREchoFilter 0", "sWA FREchoFilter")
    aria.want("sMN mEEwriteall", "sAN mEEwriteall 1")
    assert aria.hear(3.0) == []
    aria.want("sMN Run", "sAN Run 1")
    for _ in range(300):  # without a pause; 30 s at most
        if aria.ask("sRN STlms").startswith("sRA STlms 7 "):
            break
        aria.hear(0.1)
    aria.want("sRN STlms", "sRA STlms 7")
    aria.want("sEN LMDscandata 1", "sEA LMDscandata 1")
    (text,) = aria.hear(interval / 75 + 0.01)
    ranges, remissions = aria_scan(text, lms5xx=True)
    check_corridor(ranges, 1_900_000 // step + 1, unit=2)
    assert remissions[:10] == [100] * 9 + [0]


@pytest.mark.parametrize("name", ["tim551", "tim561", "tim571"])
def test_aria_with_a_tim(name: str) -> None:
    aria = AriaLaser(Room(laser(name)))
    aria.want("sEN LMDscandata 0", "sEA LMDscandata 0")
    assert aria.hear(1.0) == []
    aria.room.connection.receive(encode("sRN LMDscandata"), aria.room.now)
    assert [text[:15] for text in aria.hear(1.0)] == ["sRA LMDscandata"]
    aria.room.connection.receive(encode("sEN LMDscandata 1"), aria.room.now)
    heard = aria.hear(0.5)
    assert heard[0] == "sEA LMDscandata 1"  # it must be the very next telegram
    ranges, _ = aria_scan(heard[-1])
    check_corridor(ranges, LASERS[name].count)


def test_the_node_lms1xx_reads_each_answer_with_one_call() -> None:
    node = program("lms-111")

    def read(request: str) -> str:
        node.room.connection.receive(encode(request), node.room.now)
        segment = node.room.connection.outgoing(node.room.now)[:LMS1XX_READ]
        assert segment.startswith(b"\x02")
        assert segment.endswith(b"\x03")
        assert segment.count(b"\x02") == 1
        node.room.run(0.01)
        return segment[1:-1].decode()

    assert read("sMN SetAccessMode 03 F4724744") == "sAN SetAccessMode 1"
    configuration = read("sRN LMPscancfg").split(" ")
    assert [int(word, 16) for word in configuration[2:5]] == [5000, 1, 5000]
    assert int(configuration[5], 16) - (1 << 32) == -450_000
    assert read("sRN LMPoutputRange").split(" ")[3] == "1388"
    assert read("sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +1") == "sWA LMDscandatacfg"
    assert read("sMN LMCstartmeas") == "sAN LMCstartmeas 0"
    assert read("sRN STlms")[10] == "7"
    read("sMN Run")
    assert read("sEN LMDscandata 1") == "sEA LMDscandata 1"
    stream = b"".join(text.encode() for text in node.hear(0.5))
    assert stream.startswith(b"sSN LMDscandata ")
    assert read_after_silence(node) == "sAN SetAccessMode 1"


def read_after_silence(node: Program) -> str:
    """Log in again on the same connection, as the node does after 100 ms without a scan."""
    node.room.connection.receive(encode("sMN SetAccessMode 03 F4724744"), node.room.now)
    texts = ColaTelegramReader().feed(node.room.connection.outgoing(node.room.now))
    return next(text for text in texts if text.startswith("sAN"))


def test_sicktoolbox_sends_one_byte_every_100_ms() -> None:
    toolbox = program("lms-111")
    heard = ColaTelegramReader()

    def slowly(request: str) -> str:
        for byte in encode(request):
            toolbox.room.run(0.1)
            toolbox.room.connection.receive(bytes([byte]), toolbox.room.now)
        texts = heard.feed(toolbox.room.connection.outgoing(toolbox.room.now))
        assert len(texts) == 1
        return texts[0]

    assert slowly("sRN LMPscancfg") == "sRA LMPscancfg 1388 1 1388 FFF92230 225510"
    assert slowly("sMN SetAccessMode 03 F4724744") == "sAN SetAccessMode 1"
    assert slowly("sWN LMDscandatacfg 03 00 1 1 0 00 00 0 0 0 0 +1") == "sWA LMDscandatacfg"
    assert slowly("sRN LMPscancfg") == "sRA LMPscancfg 1388 1 1388 FFF92230 225510"
    assert slowly("sMN SetAccessMode 03 F4724744") == "sAN SetAccessMode 1"
    assert slowly("sRN STlms").startswith("sRA STlms 7 ")
    assert slowly("sEN LMDscandata 1") == "sEA LMDscandata 1"
    words = toolbox.hear(0.05)[-1].split(" ")
    assert [words.count(content) for content in ("DIST1", "DIST2", "RSSI1")] == [1, 1, 1]


@pytest.mark.parametrize("name", ["tim551", "tim561", "tim571"])
def test_sick_tim_finds_its_fields(name: str) -> None:
    node = program(name)
    assert node.ask("sRI0").split(" ")[3] == LASERS[name].product
    assert node.ask("sRN SerialNumber").split(" ")[2] == "8"
    assert node.ask("sRN FirmwareVersion").startswith("sRA FirmwareVersion ")
    assert node.ask("sRN SCdevicestate") == "sRA SCdevicestate 1"
    assert node.ask("sEN LMDscandata 1") == "sEA LMDscandata 1"
    fields = node.hear(0.2)[-1].split(" ")
    count = int(fields[25], 16)
    assert fields[15] == "0"
    assert fields[20] == "DIST1"
    assert 1 <= count <= 811
    assert len(fields) >= 26 + count + 5
    assert int(fields[24], 16) / 1e4 == pytest.approx(270 / (count - 1), abs=1e-4)
    assert node.ask("sEN LMDscandata 0") == "sEA LMDscandata 0"
    assert node.hear(0.5) == []


def test_sick_scan_xd_asks_for_much() -> None:
    node = program("tim561")
    assert node.ask("sMN LMCstopmeas") == "sFA 1"
    assert node.ask("sMN SetAccessMode 3 F4724744") == "sAN SetAccessMode 1"
    assert node.ask("sWN EIHstCola 0") == "sFA 3"
    for variable in ("FirmwareVersion", "SCdevicestate", "ODoprh", "ODpwrc", "LocationName"):
        assert node.ask(f"sRN {variable}").startswith(f"sRA {variable} ")
    before = node.ask("sRN LMPoutputRange")
    assert node.ask("sWN LMPoutputRange 1 D05 FFF92230 225510") == "sWA LMPoutputRange"
    assert node.ask("sRN LMPoutputRange") == before
    request = "sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 1"
    assert node.ask(request) == "sWA LMDscandatacfg"
    assert node.ask("sMN Run") == "sAN Run 1"
    assert node.ask("sEN LMDscandata 1") == "sEA LMDscandata 1"
    assert "RSSI1" in node.hear(0.2)[-1]
