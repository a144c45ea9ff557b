"""The simulated LMS-2xx, request by request (lms2xx.md 1.3 to 1.10, 3.3)."""

from math import inf, radians

import pytest

from pioneer3.lasers.device import MirrorTurn
from pioneer3.lasers.lms2xx import LmsDevice, commands
from pioneer3.lasers.lms2xx.blocks import UnitConfig, UnitStatus
from pioneer3.lasers.lms2xx.commands import MODE_OF_SPEED, CommandCode, OperatingMode
from pioneer3.lasers.lms2xx.measuring import Units, Variant
from pioneer3.lasers.lms2xx.scans import Measurement
from pioneer3.lasers.lms2xx.telegram import Sign, Telegram, encode
from pioneer3.models.lasers import LASERS
from tests.unit.lasers.lms_support import LMS200, Cable, signs, telegrams

TAKEN = bytes.fromhex("06 02 80 03 00 A0 00 10 16 0A")
REFUSED = bytes.fromhex("06 02 80 02 00 92 10 7F 33")
STOP = commands.mode(OperatingMode.ON_REQUEST)
STREAM = commands.mode(OperatingMode.ALL_VALUES)
TURNS = commands.mode(OperatingMode.PARTIAL_SCANS)
INSTALL = commands.mode(OperatingMode.INSTALLATION, commands.PASSWORD)
ONE_SCAN = encode(CommandCode.SCAN, b"\x01")
MM_15_BITS = bytes.fromhex("00 00 46 00 00 05 01")


def cable(start_speed: int = 9600, **options: int | float) -> Cable:
    return Cable(LmsDevice(LMS200, start_speed=start_speed, **options), speed=None)  # type: ignore[arg-type]


def measurements(data: bytes) -> list[Measurement]:
    found = [t for t in telegrams(data) if t.code in {0xB0, 0xB6, 0xB7, 0xBF}]
    return [Measurement.from_body(t.code, t.body) for t in found]


def only(data: bytes) -> Telegram:
    (telegram,) = telegrams(data)
    return telegram


def by_bearing(turn: MirrorTurn, index: int) -> float:
    return 4.0 + turn.first + index * turn.step


@pytest.mark.parametrize(
    ("request_", "answer"),
    [
        ("02 00 02 00 20 25 35 08", "02 80 03 00 A0 00 10 16 0A"),
        ("02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5", "02 80 03 00 A0 00 10 16 0A"),
        ("02 00 0A 00 20 00 53 49 43 4B 5F 50 4C 53 CC FC", "02 80 03 00 A0 01 10 14 0B"),
        ("02 00 01 00 32 16 12", "02 80 02 00 B2 10 3F 13"),
        (
            "02 00 01 00 3A 1E 12",
            "02 80 17 00 BA 4C4D533230303B3330313036313B5630322E333020 10 3D ED",
        ),
        ("02 00 05 00 3B B4 00 64 00 97 49", "02 80 07 00 BB 01 B4 00 64 00 10 5B 30"),
        ("02 00 05 00 3B B4 00 32 00 3B 1F", "02 80 07 00 BB 01 B4 00 32 00 10 03 9D"),
        ("02 00 01 00 10 34 12", "02 80 02 00 91 10 79 30"),
    ],
)
def test_answers_are_as_published(request_: str, answer: str) -> None:
    assert cable().ask(bytes.fromhex(request_)) == b"\x06" + bytes.fromhex(answer)


@pytest.mark.parametrize(
    "request_",
    [
        encode(0x55),
        encode(CommandCode.MODE),
        commands.mode(OperatingMode.RANGE_AND_REFLECTIVITY, bytes(4)),
        commands.mode(OperatingMode.SUBRANGE, bytes.fromhex("0000b500")),
        commands.mode(OperatingMode.SUBRANGE, bytes.fromhex("0100ffff")),
        commands.mode(OperatingMode.MEAN),
        commands.mode(OperatingMode.MEAN, b"\x01"),
        commands.mode(OperatingMode.MEAN, b"\xfb"),
        commands.mode(OperatingMode.MEAN_OF_SUBRANGE, bytes.fromhex("0a0000b500")),
        encode(CommandCode.SCAN, b"\x02"),
        encode(CommandCode.CONFIGURE, MM_15_BITS),
        encode(CommandCode.KEEP_SPEED, b"\x01"),
    ],
)
def test_what_is_unknown_or_in_the_wrong_mode_is_refused(request_: bytes) -> None:
    assert cable().ask(request_) == REFUSED


def test_one_scan_is_refused_but_on_request() -> None:
    line = cable()
    line.ask(INSTALL)
    assert line.ask(ONE_SCAN) == REFUSED


def test_an_impossible_variant_is_not_taken() -> None:
    answer = only(cable().ask(commands.variant(Variant(180, 25))))
    assert answer.body == b"\x00" + commands.variant_data(Variant(180, 50))


def test_a_spoilt_request_gets_nak() -> None:
    line = cable()
    assert line.ask(STOP[:-1] + b"\x09") == b"\x15"
    assert line.ask(STOP) == TAKEN


@pytest.mark.parametrize("cut", range(1, len(STOP)))
def test_requests_come_in_pieces(cut: int) -> None:
    line = cable()
    line.send(STOP[:cut])
    line.listen(0.03)
    assert line.ask(STOP[cut:]) == TAKEN


def test_a_request_behind_a_false_beginning_is_served_after_a_pause() -> None:
    line = cable()
    assert line.ask(b"\x02\x00\x20\x00\x20" + STOP) == TAKEN


def test_another_address_is_not_for_this_unit() -> None:
    request = encode(CommandCode.TYPE, address=0x02)
    assert cable(address=0x81).ask(request) == b""
    assert only(cable(address=0x82).ask(request)).address == 0x82


def test_bytes_leave_at_the_speed_of_the_line() -> None:
    line = cable()
    line.send(encode(CommandCode.STATUS))
    arrived = [len(line.step(0.01)) for _ in range(20)]
    assert sum(arrived) == 1 + 160
    assert arrived[:16] == pytest.approx([9.6] * 16, abs=1)
    assert line.device.deadline == inf


@pytest.mark.parametrize(
    ("request_", "baud"),
    [(commands.mode(mode), baud) for baud, mode in commands.MODE_OF_SPEED.items()],
)
def test_a_new_speed_holds_once_the_answer_has_left(request_: bytes, baud: int) -> None:
    line = cable(19200)
    line.send(request_)
    heard = b""
    while len(heard) < len(TAKEN):
        assert line.device.speed == 19200
        heard += line.step()
    line.step()
    assert heard == TAKEN
    assert line.device.speed == baud
    status = UnitStatus.from_bytes(only(line.ask(encode(CommandCode.STATUS))).body)
    assert status.speed == baud


def test_the_unit_does_not_hear_other_speeds() -> None:
    line = cable(38400)
    line.speed = 9600
    assert line.ask(STOP) == b""


def test_a_scan_has_the_variant_and_its_bearings() -> None:
    line = cable(38400)
    line.scene = by_bearing
    for variant in ((180, 100), (180, 50), (100, 100), (100, 50), (100, 25)):
        wanted = Variant(*variant)
        line.ask(commands.variant(wanted))
        (scan,) = measurements(line.ask(ONE_SCAN))
        assert scan.units == Units.CENTIMETRES
        assert len(scan.values) == wanted.count
        half = radians(wanted.field_deg / 2)
        expected = [4 - half + radians(i * wanted.step_cdeg / 100) for i in range(wanted.count)]
        assert [value / 100 for value in scan.values] == pytest.approx(expected, abs=0.006)
    assert line.device.turn is None


@pytest.mark.parametrize(
    ("baud", "variant", "period"),
    [
        (9600, (180, 100), 30 / 75),  # 372 bytes take 29.1 turns
        (38400, (180, 100), 8 / 75),
        (38400, (180, 50), 16 / 75),  # 4.7 scans a second, as reported
        (38400, (100, 25), 16 / 75),
        (500000, (180, 100), 1 / 75),
        (500000, (180, 50), 2 / 75),
        (500000, (100, 25), 4 / 75),
    ],
)
def test_the_line_sets_the_rate(baud: int, variant: tuple[int, int], period: float) -> None:
    line = cable(baud)
    line.ask(commands.variant(Variant(*variant)))
    line.ask(STREAM, 1.0)
    seconds = 40 * period
    size = 2 * Variant(*variant).count + 10
    assert len(line.listen(seconds)) / size == pytest.approx(40, abs=1.1)


def test_the_stream_goes_on_without_a_host() -> None:
    line = cable(38400)
    line.ask(STREAM)
    line.port.close()
    line.port = line.device.connect()
    assert len(measurements(line.listen(1.0))) >= 4


def test_a_host_in_the_network_finds_the_line_empty_at_the_speed_that_was_asked_for() -> None:
    line = cable(9600)
    line.port.receive(commands.mode(MODE_OF_SPEED[38400]) + encode(CommandCode.TYPE)[:3], line.now)
    line.port = line.device.connect(network=True)
    line.speed = None
    assert line.listen(1.0) == b""
    assert line.device.speed == 38400
    assert line.ask(encode(CommandCode.ERRORS)).startswith(b"\x06\x02\x80")


def test_a_stream_can_be_changed_and_stopped() -> None:
    line = cable(38400)
    line.ask(STREAM, 0.5)
    heard = measurements(line.ask(commands.variant(Variant(100, 100)), 0.5))
    assert len(heard[-1].values) == 101
    line.ask(STOP)
    assert line.device.unit.mode is OperatingMode.ON_REQUEST
    assert line.listen(0.5) == b""


def test_single_turns_come_in_order() -> None:
    line = cable(38400)
    line.scene = by_bearing
    line.ask(commands.variant(Variant(100, 25)))
    scans = measurements(line.ask(TURNS, 1.0))
    assert len(scans) >= 8
    for index, scan in enumerate(scans):
        offset = (0, 25, 50, 75)[index % 4]
        assert (scan.partial, scan.offset_cdeg) == (True, offset)
        assert len(scan.values) == 101 - (offset > 0)
        expected = 4 - radians(50 - offset / 100)
        assert scan.values[0] / 100 == pytest.approx(expected, abs=0.006)


@pytest.mark.parametrize(
    ("wanted", "data", "first", "last"),
    [(OperatingMode.MEAN, "0a", 1, 181), (OperatingMode.MEAN_OF_SUBRANGE, "0a5b005d00", 91, 93)],
)
def test_the_mean_of_ten_scans(wanted: OperatingMode, data: str, first: int, last: int) -> None:
    def scene(_turn: MirrorTurn, index: int) -> float:
        return inf if index == 91 and line.turns % 2 else 1.0 + line.turns % 10 / 100

    line = cable(38400)
    line.scene = scene
    line.ask(commands.variant(Variant(180, 100)))
    scans = measurements(line.ask(commands.mode(wanted, bytes.fromhex(data)), 2.0))
    assert len(scans) == 14  # one in ten turns, 13.3 ms each
    for scan in scans:
        assert scan.sample == 10
        assert len(scan.values) == last - first + 1
        assert (scan.first, scan.last) == ((first, last) if wanted in commands.PARTS else (0, 0))
        assert scan.values[91 - first] in {104, 105}  # even turns only, or odd ones
        assert scan.values[92 - first] == 104


def test_a_part_of_the_values() -> None:
    line = cable(38400)
    line.scene = by_bearing
    line.ask(commands.variant(Variant(180, 100)))
    scan = measurements(line.ask(commands.mode(OperatingMode.SUBRANGE, bytes.fromhex("5b005d00"))))[
        -1
    ]
    assert (scan.first, scan.last) == (91, 93)
    assert scan.values == (400, 402, 403)


def test_nothing_seen_and_nothing_measured_have_their_codes() -> None:
    line = cable(38400)
    line.scene = lambda _, index: (inf, 100.0, 0.0, 1.0)[index % 4]
    line.ask(commands.variant(Variant(100, 100)))
    assert measurements(line.ask(ONE_SCAN))[0].values[:4] == (8183, 8183, 1, 100)
    line.ask(INSTALL)
    line.ask(encode(CommandCode.CONFIGURE, MM_15_BITS))
    line.ask(STOP)
    assert measurements(line.ask(ONE_SCAN))[0].values[:4] == (32759, 32759, 1, 1000)


def test_reflectors_show_and_walls_do_not() -> None:
    line = cable(38400)
    line.device.unit.config = UnitConfig(measuring_mode=0x01, units=Units.MILLIMETRES)
    for light, level in ((0.5, 0), (1.2, 0), (2.0, 1), (50.0, 7)):
        line.intensity = light
        (scan,) = measurements(line.ask(ONE_SCAN, 1.0))
        assert scan.values[0] == 2000 | level << 13


def test_indices_are_sent_where_they_are_wanted() -> None:
    line = cable(38400)
    line.device.unit.config = UnitConfig(availability=2)
    scans = measurements(line.ask(STREAM, 1.0))
    telegram_indices = [scan.indices[1] for scan in scans]
    assert telegram_indices == [*range(len(scans))]
    assert scans[1].indices[0] - scans[0].indices[0] == 8


@pytest.mark.parametrize("size", [7, 8, 32, 34])
def test_the_configuration_is_written_in_installation_mode(size: int) -> None:
    line = cable()
    block = MM_15_BITS + UnitConfig().to_bytes()[7:]
    line.ask(INSTALL)
    answer = only(line.ask(encode(CommandCode.CONFIGURE, block[:size])))
    assert answer.body == b"\x01" + block
    assert only(line.ask(encode(CommandCode.CONFIG))).body == block
    assert line.device.unit.config_writes == 1


def test_an_impossible_configuration_is_not_taken() -> None:
    line = cable()
    line.ask(INSTALL)
    answer = only(line.ask(encode(CommandCode.CONFIGURE, bytes.fromhex("00004600000701"))))
    assert answer.body == b"\x00" + UnitConfig().to_bytes()
    assert line.device.unit.config_writes == 0


def test_a_power_cycle_keeps_the_eeprom_alone() -> None:
    line = cable(38400, boot=5.0)
    line.ask(INSTALL)
    line.ask(encode(CommandCode.CONFIGURE, MM_15_BITS))
    line.ask(commands.variant(Variant(100, 100)))
    line.ask(STREAM)
    line.device.switch_on(line.now)
    assert line.device.speed == 9600
    assert line.ask(STOP, 4.9) == b""
    ready = only(line.listen(0.2))
    assert (ready.code, ready.body) == (0x90, b"LMS200;301061;V02.30 ")
    status = UnitStatus.from_bytes(only(line.ask(encode(CommandCode.STATUS))).body)
    assert (status.mode, status.variant, status.speed) == (0x25, Variant(180, 50), 9600)
    assert (status.measuring_mode, status.units) == (5, 1)


def test_a_kept_speed_is_that_after_power_on() -> None:
    line = cable(19200, boot=1.0)
    line.ask(INSTALL)
    assert only(line.ask(encode(CommandCode.KEEP_SPEED, b"\x01"))).code == 0xE6
    line.ask(commands.mode(OperatingMode.SPEED_38400))
    line.device.switch_on(line.now)
    assert line.device.speed == 19200
    line.listen(1.1)
    status = UnitStatus.from_bytes(only(line.ask(encode(CommandCode.STATUS))).body)
    assert (status.speed, status.keeps_speed) == (19200, 1)


def test_a_reset_answers_and_starts_anew_at_9600() -> None:
    line = cable(38400, boot=5.0)
    line.ask(STREAM)
    line.ask(STOP)
    line.ask(commands.variant(Variant(100, 100)))
    assert only(line.ask(encode(CommandCode.RESET))).code == 0x91
    assert line.device.speed == 9600
    assert line.ask(STOP, 4.5) == b""
    assert only(line.listen(0.3)).code == 0x90
    assert line.device.unit.variant == Variant(180, 50)


@pytest.mark.parametrize("delay", [0.3, 1.5])
def test_answers_may_be_late_and_stay_in_order(delay: float) -> None:
    device = LmsDevice(LMS200, delays={CommandCode.MODE: delay})
    line = Cable(device)
    assert line.ask(STOP + encode(CommandCode.TYPE), 0.9 * delay) == b"\x06\x06"
    assert [telegram.code for telegram in telegrams(line.listen(0.5))] == [0xA0, 0xBA]


def test_a_flood_of_requests_fills_no_memory() -> None:
    line = cable()
    for _ in range(200):
        line.send(encode(CommandCode.STATUS) * 50)
        line.send(encode(CommandCode.STATUS)[:-1] + b"\0")
    assert line.device._line.waiting < 4096
    heard = line.listen(20.0)
    assert set(signs(heard)) == {Sign.ACK, Sign.NAK}
    assert 8 <= len(telegrams(heard)) < 100
    assert line.ask(STOP) == TAKEN


def test_other_models_say_what_they_are() -> None:
    line = Cable(LmsDevice(LASERS["lms-291"]))
    assert only(line.ask(encode(CommandCode.TYPE))).body == b"LMS291;S05   ;V02.30 "
