"""The simulated laser, request by request."""

from math import degrees, inf

import pytest

from pioneer3.errors import ConfigError
from pioneer3.lasers.cola.device import ColaDevice
from pioneer3.lasers.cola.scan import ScanData, decode
from pioneer3.lasers.cola.wire import ColaTelegramReader, TelegramWords, encode
from pioneer3.lasers.device import LaserDevice
from pioneer3.models.lasers import LASERS
from tests.unit.lasers.cola_room import LOGIN, Program, Room, laser, program

SCAN_CONFIG = "+5000 +1 +5000 -450000 +2250000"
DATA_CONFIG = "sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +1"
QUARTER = "sAN mLMPsetscancfg 0 9C4 1 9C4 FFF92230 225510"
MODELS = ["lms-111", "lms-511", "tim551", "tim561", "tim571"]


def scans(texts: list[str]) -> list[ScanData]:
    """Return the scans among `texts`, all of which must be well formed."""
    return [
        decode(TelegramWords(text.split(" ")[2:]))
        for text in texts
        if text.split(" ")[1] == "LMDscandata" and text[:3] in {"sSN", "sRA"}
    ]


def logged_in(name: str = "lms-111") -> Program:
    host = program(name)
    assert host.ask(LOGIN) == "sAN SetAccessMode 1"
    return host


def test_it_is_a_device() -> None:
    device: LaserDevice = laser()
    assert device.speed is None


def test_only_models_that_speak_cola_are_simulated() -> None:
    with pytest.raises(ConfigError):
        ColaDevice(LASERS["utm-30lx"])


@pytest.mark.parametrize(
    ("request_", "answer"),
    [
        ("sRN LMPscancfg", "sRA LMPscancfg 1388 1 1388 FFF92230 225510"),
        ("sRN LMPoutputRange", "sRA LMPoutputRange 1 1388 FFF92230 225510"),
        ("sRN LMDscandatacfg", "sRA LMDscandatacfg 01 00 0 0 0 00 00 0 0 0 0 1"),
        ("sRN FREchoFilter", "sRA FREchoFilter 0"),
        ("sRN STlms", "sRA STlms 7 0 8 00:00:00 8 01.01.06 0 0 0"),
        ("sRN SCdevicestate", "sRA SCdevicestate 1"),
        ("sRI0", "sRA 0 6 LMS111 10 V1.36-21.10.2010"),
        ("sRN DeviceIdent", "sRA DeviceIdent 6 LMS111 10 V1.36-21.10.2010"),
        ("sRN SerialNumber", "sRA SerialNumber 8 10010001"),
        ("sRN FirmwareVersion", "sRA FirmwareVersion 10 V1.36-21.10.2010"),
        ("sRN LocationName", "sRA LocationName B not defined"),
        ("sRN ODoprh", "sRA ODoprh 0"),
        ("sRN ODpwrc", "sRA ODpwrc 0"),
        ("sMN SetAccessMode 3 F4724744", "sAN SetAccessMode 1"),
        ("sMN SetAccessMode 02 B21ACE26", "sAN SetAccessMode 1"),
        ("sMN SetAccessMode 04 81BE23AA", "sAN SetAccessMode 1"),
        ("sMN SetAccessMode 03 81BE23AA", "sAN SetAccessMode 0"),
        ("sMN SetAccessMode 05 0", "sAN SetAccessMode 0"),
        ("sMN Run", "sAN Run 1"),
        ("sEN LMDscandata 1", "sEA LMDscandata 1"),
        ("sEN LMDscandata 0", "sEA LMDscandata 0"),
        ("sRN Nonsense", "sFA 3"),
        ("sWN Nonsense 1", "sFA 3"),
        ("sMN Nonsense", "sFA 2"),
        ("sEN Nonsense 1", "sFA F"),
        ("sXN STlms", "sFA C"),
        ("sRN", "sFA 11"),
        ("sEN LMDscandata 2", "sFA 11"),
    ],
)
def test_an_answer_to_everyone(request_: str, answer: str) -> None:
    assert program().ask(request_) == answer


@pytest.mark.parametrize(
    ("request_", "answer"),
    [
        (f"sMN mLMPsetscancfg {SCAN_CONFIG}", "sAN mLMPsetscancfg 0 1388 1 1388 FFF92230 225510"),
        ("sMN mLMPsetscancfg 9C4 1 9C4 FFF92230 225510", QUARTER),
        ("sWN LMPoutputRange 1 1388 FFF92230 225510", "sWA LMPoutputRange"),
        (DATA_CONFIG, "sWA LMDscandatacfg"),
        ("sWN LMDscandatacfg 1 0 0 0 0 0 0 0 0 0 0 1", "sWA LMDscandatacfg"),
        ("sWN FREchoFilter 0", "sWA FREchoFilter"),
        ("sMN LSPsetdatetime +2026 +11 +22 +5 +32 +23 0", "sAN LSPsetdatetime 1"),
        ("sMN LSPsetdatetime +2026 +13 +22 +5 +32 +23 0", "sAN LSPsetdatetime 0"),
        ("sMN mEEwriteall", "sAN mEEwriteall 1"),
        ("sMN LMCstartmeas", "sAN LMCstartmeas 0"),
        ("sMN LMCstopmeas", "sAN LMCstopmeas 0"),
        ("sMN mSCreboot", "sAN mSCreboot"),
    ],
)
def test_an_answer_after_the_login_and_a_refusal_before(request_: str, answer: str) -> None:
    refusal = "sFA A" if request_.startswith("sWN") else "sFA 1"
    assert program().ask(request_) == refusal
    assert logged_in().ask(request_) == answer


@pytest.mark.parametrize(
    "request_",
    [
        "sWN FREchoFilter 3",
        "sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +0",
        "sWN LMDscandatacfg 00 00 1 1 0 00 00 0 0 0 0 +1",
        "sWN LMPoutputRange 1 1388 FFF92230 225511",
        "sWN LMPoutputRange 1 1388 225510 FFF92230",
    ],
)
def test_values_that_cannot_be_are_refused(request_: str) -> None:
    assert logged_in().ask(request_) == "sFA 4"


def test_run_logs_out() -> None:
    host = logged_in()
    host.ask("sMN Run")
    assert host.ask(DATA_CONFIG) == "sFA A"


def test_a_login_is_that_of_one_connection() -> None:
    host = logged_in()
    other = Program(Room(host.room.laser))
    assert other.ask(DATA_CONFIG) == "sFA A"


@pytest.mark.parametrize(
    ("name", "wanted", "code"),
    [
        ("lms-111", "+5000 +1 +5000 -450000 +2250000", 0),
        ("lms-111", "+2500 +1 +2500 -450000 +2250000", 0),
        ("lms-111", "+2500 +1 +5000 -450000 +2250000", 0),
        ("lms-111", "+7500 +1 +5000 -450000 +2250000", 1),
        ("lms-111", "+5000 +1 +2500 -450000 +2250000", 2),
        ("lms-111", "+5000 +1 +1000 -450000 +2250000", 2),
        ("lms-111", "+1500 +1 +1000 -450000 +2250000", 3),
        ("lms-111", "+5000 +1 +5000 -450001 +2250000", 4),
        ("lms-111", "+5000 +1 +5000 +450000 -450000", 4),
        ("lms-111", "+5000 +2 +5000 -450000 +2250000", 5),
        ("lms-511", "+7500 +1 +10000 -50000 +1850000", 0),
        ("lms-511", "+7500 +1 +5000 -50000 +1850000", 0),
        ("lms-511", "+2500 +1 +1667 -50000 +1850000", 0),
        ("lms-511", "+10000 +1 +1667 -50000 +1850000", 2),
        ("tim551", "+1500 +1 +10000 -450000 +2250000", 0),
        ("tim551", "+1500 +1 +3333 -450000 +2250000", 5),
        ("tim551", "+2500 +1 +10000 -450000 +2250000", 1),
    ],
)
def test_the_code_for_a_scan_that_is_wanted(name: str, wanted: str, code: int) -> None:
    host = logged_in(name)
    before = host.ask("sRN LMPscancfg").split(" ", 2)[2]
    answer = host.ask(f"sMN mLMPsetscancfg {wanted}")
    after = host.ask("sRN LMPscancfg").split(" ", 2)[2]
    assert answer == f"sAN mLMPsetscancfg {code} {after}"
    assert code == 0 or after == before


@pytest.mark.parametrize("name", MODELS)
def test_a_scan_has_the_readings_of_its_model(name: str) -> None:
    host, model = program(name), LASERS[name]
    host.ask("sEN LMDscandata 1")
    texts = host.hear(5.5 * model.turn)
    assert [text[:15] for text in texts] == ["sSN LMDscandata"] * 5
    for number, scan in enumerate(scans(texts), start=1):
        (ranges,) = scan.channels
        assert len(ranges.values) == model.count
        assert ranges.scale == (2.0 if name == "lms-511" else 1.0)
        assert ranges.values[:2] == ((500, 501) if name == "lms-511" else (1000, 1002))
        assert ranges.values[9] == 0
        assert scan.scans == scan.telegrams == number
        assert scan.frequency_chz == round(100 / model.turn)
        assert scan.narrow_channels == ()


@pytest.mark.parametrize(("name", "start"), [("lms-111", "FFF92230"), ("lms-511", "FFFF3CB0")])
def test_start_angles_have_eight_digits(name: str, start: str) -> None:
    host = logged_in(name)
    host.ask("sEN LMDscandata 1")
    words = next(t for t in host.hear(0.05) if t.startswith("sSN")).split(" ")
    assert words[20 + 3] == start
    host.ask("sWN LMPoutputRange 1 1388 6DDD0 DBBA0")
    words = host.hear(0.05)[-1].split(" ")
    assert words[20 + 3] == "0006DDD0"
    assert int(words[20 + 5], 16) == 91


def test_five_zeros_end_a_scan() -> None:
    host = program()
    host.ask("sEN LMDscandata 1")
    assert all(text.endswith(" 0 0 0 0 0 0") for text in host.hear(0.1))


def test_a_subscriber_hears_its_answer_first_and_silence_after_the_end() -> None:
    host = program()
    host.hear(1.0)
    assert host.ask("sEN LMDscandata 1") == "sEA LMDscandata 1"
    host.room.run(0.025)  # a scan waits to leave
    assert host.room.connection.has_output
    assert host.ask("sEN LMDscandata 0") == "sEA LMDscandata 0"
    assert host.hear(1.0) == []


def test_each_subscriber_gets_each_scan() -> None:
    host = program()
    other = Program(Room(host.room.laser))
    host.ask("sEN LMDscandata 1")
    assert len(host.hear(0.11)) == 5
    other.ask("sEN LMDscandata 1")
    host.hear(0.105)
    waiting = ColaTelegramReader().feed(other.room.connection.outgoing(0.215))
    assert len(waiting) == 2  # of those that have not left, the latest two
    other.room.connection.close()
    assert len(host.hear(0.1)) == 5
    assert other.room.connection.outgoing(1.0) == b""


def test_nobody_there_means_no_turn() -> None:
    host = program()
    assert host.room.laser.turn is None
    host.ask("sEN LMDscandata 1")
    turn = host.room.laser.turn
    assert turn is not None
    assert degrees(turn.first) == pytest.approx(-135)
    assert (turn.count, turn.period) == (541, 0.02)
    assert degrees(turn.step) == pytest.approx(0.5)
    assert turn.beam_time * 720 == pytest.approx(0.02)
    host.room.connection.close()
    assert host.room.laser.turn is None


def test_one_scan_is_the_next_where_the_last_is_old() -> None:
    host = program()
    for _ in range(2):
        host.room.connection.receive(encode("sRN LMDscandata"), host.room.now)
        assert host.room.connection.outgoing(host.room.now) == b""
        assert host.room.laser.turn is not None
        assert [text[:15] for text in host.hear(0.1)] == ["sRA LMDscandata"]
        assert host.room.laser.turn is None
    host.ask("sEN LMDscandata 1")
    last = host.hear(0.021)[-1]
    assert host.ask("sRN LMDscandata") == last.replace("sSN", "sRA")


def test_every_third_scan() -> None:
    host = logged_in()
    host.ask("sWN LMDscandatacfg 01 00 0 0 0 00 00 0 0 0 0 +3")
    host.ask("sEN LMDscandata 1")
    found = scans(host.hear(0.19))
    assert [scan.scans for scan in found] == [3, 6, 9]
    assert [scan.telegrams for scan in found] == [1, 2, 3]


def test_remissions_have_8_or_16_bits() -> None:
    host = logged_in()
    host.ask("sEN LMDscandata 1")
    host.ask("sWN LMDscandatacfg 01 00 1 0 0 00 00 0 0 0 0 +1")
    narrow = scans(host.hear(0.05))[-1]
    assert [c.content for c in narrow.channels] == ["DIST1"]
    assert narrow.narrow_channels[0].values[8:10] == (100, 0)
    host.ask("sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +1")
    wide = scans(host.hear(0.05))[-1]
    assert [c.content for c in wide.channels] == ["DIST1", "RSSI1"]
    assert wide.channels[1].values[8:10] == (25600, 0)
    assert wide.narrow_channels == ()


def test_blocks_that_are_switched_on() -> None:
    host = logged_in()
    host.ask("sMN LSPsetdatetime +2026 +11 +22 +5 +32 +23 0")
    host.ask("sWN LMDscandatacfg 01 00 0 0 0 01 00 1 1 1 1 +1")
    host.ask("sEN LMDscandata 1")
    scan = scans(host.hear(0.021))[0]
    assert (scan.name, scan.comment, len(scan.encoders)) == ("not defined", "not defined", 1)
    assert scan.position is not None
    assert scan.moment is not None
    assert (scan.moment.year, scan.moment.minute, scan.moment.microsecond) == (2026, 32, 20000)


@pytest.mark.parametrize(
    ("echo_filter", "contents", "last"),
    [(0, ["DIST1"], 1000), (1, ["DIST1", "DIST2", "DIST3"], 500), (2, ["DIST1"], 2000)],
)
def test_the_echoes_of_an_lms5xx(echo_filter: int, contents: list[str], last: int) -> None:
    room = Room(laser("lms-511"))
    room.ranges = lambda turn: [1.0] * turn.count
    room.echoes = lambda turn: [(1.0, 2.0, 4.0)] * (turn.count - 1) + [()]
    if echo_filter == 0:
        room.ranges = lambda turn: [2.0] * turn.count
    host = Program(room)
    host.ask(LOGIN)
    host.ask(f"sWN FREchoFilter {echo_filter}")
    host.ask("sWN LMDscandatacfg 07 00 0 0 0 00 00 0 0 0 0 +1")
    host.ask("sEN LMDscandata 1")
    scan = scans(host.hear(0.03))[0]
    assert [c.content for c in scan.channels] == contents
    assert scan.channels[0].values[0] == last
    if echo_filter == 1:
        assert [c.values[0] for c in scan.channels] == [500, 1000, 2000]
        assert scan.channels[2].values[-1] == 0


def test_the_mirror_takes_its_time() -> None:
    device = laser(spin_up=15.0)
    device.switch_on(100.0)
    host = Program(Room(device, now=100.0))
    assert device.deadline == 115.0
    assert host.ask("sRN STlms").startswith("sRA STlms 4 ")
    assert host.ask("sRN SCdevicestate") == "sRA SCdevicestate 0"
    host.ask("sEN LMDscandata 1")
    assert host.hear(14.9) == []
    texts = host.hear(0.2)
    assert len(texts) >= 3
    assert scans(texts)[0].sensed_us == pytest.approx(15_000_000, abs=10_000)
    assert host.ask("sRN STlms").startswith("sRA STlms 7 0 8 00:00:15 8 01.01.06")
    assert device.deadline == inf


def test_a_stopped_laser_sends_nothing() -> None:
    host = logged_in()
    host.ask("sEN LMDscandata 1")
    host.ask("sMN LMCstopmeas")
    assert host.ask("sRN STlms").startswith("sRA STlms 6 ")
    host.hear(0.021)
    assert host.hear(1.0) == []
    host.ask("sMN LMCstartmeas")
    assert len(host.hear(0.1)) >= 4


@pytest.mark.parametrize("stored", [False, True])
def test_settings_outlive_connections_and_if_stored_power_cycles(stored: bool) -> None:
    host = logged_in()
    device = host.room.laser
    host.ask("sMN mLMPsetscancfg +2500 +1 +2500 -450000 +2250000")
    host.ask(DATA_CONFIG)
    if stored:
        host.ask("sMN mEEwriteall")
    host.room.connection.close()
    changed = "sRA LMPscancfg 9C4 1 9C4 FFF92230 225510"
    assert Program(Room(device)).ask("sRN LMPscancfg") == changed
    device.switch_on(10.0)
    after = Program(Room(device, now=10.0))
    assert (after.ask("sRN LMPscancfg") == changed) is stored
    assert (after.ask("sRN LMDscandatacfg").split(" ")[4] == "1") is stored
    assert after.ask("sRN ODpwrc") == "sRA ODpwrc 1"


def test_a_power_cycle_ends_connections() -> None:
    host = program()
    host.ask("sEN LMDscandata 1")
    host.room.laser.switch_on(1.0)
    host.room.connection.receive(encode("sRI0"), 1.0)
    assert host.hear(2.0) == []
    assert host.room.laser.turn is None


def test_a_reboot_is_answered_first() -> None:
    host = logged_in()
    assert host.ask("sMN mSCreboot") == "sAN mSCreboot"
    host.room.connection.receive(encode("sRI0"), 0.0)
    assert host.room.connection.outgoing(0.0) == b""


def test_the_output_range_is_the_part_that_is_sent() -> None:
    host = logged_in()
    host.ask("sWN LMPoutputRange 1 1388 0 1B7740")
    host.ask("sEN LMDscandata 1")
    turn = host.room.laser.turn
    assert turn is not None
    assert degrees(turn.first) == pytest.approx(-90)
    assert turn.count == 361
    (ranges,) = scans(host.hear(0.03))[0].channels
    assert (ranges.first_tick, len(ranges.values)) == (0, 361)


def test_output_is_due_at_once() -> None:
    host = program()
    host.room.connection.receive(encode("sRI0"), 3.0)
    assert host.room.laser.deadline == 3.0
    host.room.connection.outgoing(3.0)
    assert host.room.laser.deadline == inf


def test_the_front_screen_may_be_dirty() -> None:
    host = program()
    host.room.laser.unit.status = (0, 2)
    host.ask("sEN LMDscandata 1")
    assert scans(host.hear(0.03))[0].status == (0, 2)


@pytest.mark.parametrize(
    ("metres", "value"), [(0.005, 16), (-0.02, 16), (-inf, 0), (inf, 0), (65.5, 65500), (66.0, 0)]
)
def test_no_range_is_taken_for_a_code(metres: float, value: int) -> None:
    host = program()
    host.room.ranges = lambda turn: [metres] * turn.count
    host.ask("sEN LMDscandata 1")
    assert set(scans(host.hear(0.03))[0].channels[0].values) == {value}
