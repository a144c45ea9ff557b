"""The simulated laser answers as the real one; programs of others find what they expect."""

import pytest

from pioneer3.lasers.device import LaserDevice, MirrorTurn, Sweep
from pioneer3.lasers.scip.device import ScipDevice
from pioneer3.lasers.scip.scans import FORMATS, decode
from pioneer3.lasers.scip.wire import decode_stamp, from_pairs, unseal
from pioneer3.models.lasers import LASERS, load_laser
from tests.unit.lasers.scip_rig import URG, UST, UTM

INF = float("inf")


class Bench:
    """A laser and one host; each question waits for all of its answer."""

    def __init__(self, device: ScipDevice) -> None:
        self.device = device
        self.host = device.connect()
        self.now = 10.0

    def ask(self, text: str) -> str:
        """Return the answer to a command."""
        self.host.receive(text.encode() + b"\n", self.now)
        return self.read()

    def read(self) -> str:
        """Return all that comes within two seconds."""
        data = b""
        for _ in range(200):
            self.now += 0.01
            data += self.host.outgoing(self.now)
        return data.decode("latin-1")

    def turn(self, ranges: list[float] | None = None) -> str:
        """Let the mirror turn once; return the bytes that follow."""
        turn = self.device.turn
        assert turn is not None
        sweep = Sweep(
            turn=turn,
            began=self.now,
            ranges=ranges or [1.5] * turn.count,
            intensities=[0.5] * turn.count,
        )
        self.now += turn.period
        self.device.measured(sweep, self.now)
        return self.read()

    def distances(self, scan: str, letters: str, count: int) -> list[int]:
        """Return the distances of a scan."""
        lines = scan.rstrip("\n").encode().split(b"\n")
        first = 2 if letters == "G" else 3
        readings = decode(lines[first:], FORMATS[letters], count, summed=letters != "G")
        assert readings is not None
        return readings.distances


def status(answer: str) -> str:
    """Return the status of an answer with a right checksum."""
    text = unseal(answer.split("\n")[1].encode())
    assert text is not None
    return text.decode()


@pytest.fixture
def urg() -> Bench:
    return Bench(ScipDevice(URG, scip1=False))


@pytest.fixture
def ust() -> Bench:
    return Bench(ScipDevice(UST))


@pytest.fixture
def utm() -> Bench:
    return Bench(ScipDevice(UTM))


def test_it_is_a_device() -> None:
    device: LaserDevice = ScipDevice(UTM)
    assert device.turn is None
    with pytest.raises(ValueError, match="does not speak SCIP"):
        ScipDevice(load_laser("lms-200"))


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("BM", "00"),
        ("QT", "00"),
        ("RS", "00"),
        ("%SL", "00"),
        ("RB", "01"),
        ("TM1", "04"),
        ("TM2", "03"),
        ("TM3", "01"),
        ("XX", "0E"),
        ("VVV", "0E"),
        ("VV;a comment of mine", "0G"),
        ("VV;<comment>", "0H"),
        ("VV;comment", "00"),
        ("SCIP2.0", "0E"),
        ("GD0044072501", "10"),
        ("MD0044072501000", "00"),
        ("MDx044072501000", "01"),
        ("MD0044x72501000", "02"),
        ("MD00440725x1000", "03"),
        ("MD0044072601000", "04"),
        ("MD0700069901000", "05"),
        ("MD004407250100", "0C"),
        ("MD0044072501x00", "06"),
        ("MD00440725010x0", "07"),
        ("ME0044072501000", "0E"),
        ("ND0044072501000", "0E"),
        ("SS019200", "03"),
        ("SS115200", "00"),
        ("SS012345", "02"),
        ("SSfast!!", "01"),
        ("CR00", "03"),
        ("CR05", "00"),
        ("CR11", "02"),
        ("CRxx", "01"),
        ("HS0", "02"),
        ("HS1", "00"),
        ("HS2", "01"),
    ],
)
def test_statuses_are_those_of_the_vendor(urg: Bench, command: str, expected: str) -> None:
    answer = urg.ask(command)
    assert answer.startswith(command + "\n")
    assert answer.endswith("\n\n")
    assert status(answer) == expected


def test_a_laser_on_ethernet_has_no_bit_rate(ust: Bench) -> None:
    assert status(ust.ask("SS115200")) == "0F"
    assert status(ust.ask("CR05")) == "04"
    assert ust.device.speed is None


def test_a_laser_on_usb_has_a_bit_rate_of_no_meaning(utm: Bench) -> None:
    assert status(utm.ask("SS115200")) == "04"


def test_the_laser_is_switched_on_once(urg: Bench) -> None:
    assert status(urg.ask("BM")) == "00"
    assert status(urg.ask("BM")) == "02"
    assert "LASR:ON;" in urg.ask("II")
    urg.ask("QT")
    assert status(urg.ask("BM")) == "00"


def test_nothing_but_time_is_told_in_time_mode(urg: Bench) -> None:
    assert status(urg.ask("TM0")) == "00"
    assert status(urg.ask("TM0")) == "02"
    assert urg.ask("QT") == "QT\n0Ee\n\n"
    answer = urg.ask("TM1").split("\n")
    assert decode_stamp(answer[2].encode()) == pytest.approx(urg.now * 1000 - 2000, abs=1)
    assert status(urg.ask("TM2")) == "00"
    assert urg.ask("QT") == "QT\n00P\n\n"


@pytest.mark.parametrize("ending", [b"\n", b"\r", b"\r\n"])
def test_commands_end_in_lf_or_cr(ust: Bench, ending: bytes) -> None:
    for byte in b"VV" + ending:
        ust.host.receive(bytes([byte]), ust.now)
    assert ust.read().startswith("VV\n00P\nVEND:")


def test_a_stream_counts_down_to_zero_and_switches_the_laser_off(ust: Bench) -> None:
    assert ust.ask("MD0540054001003") == "MD0540054001003\n00P\n\n"
    for left in (2, 1, 0):
        assert ust.turn().startswith(f"MD05400540010{left:02}"[:13] + f"{left:02}\n99b\n")
    assert ust.device.turn is None
    assert "LASR:OFF;" in ust.ask("II")


def test_skipped_turns_are_not_sent(ust: Bench) -> None:
    ust.ask("MD0540054001200;x")
    sent = [bool(ust.turn()) for _ in range(7)]
    assert sent == [True, False, False, True, False, False, True]


def test_a_cluster_is_its_shortest_reading(utm: Bench) -> None:
    utm.ask("MD0000108003000")
    scan = utm.turn([INF, 0.01, 3.0, 2.0, INF, 1.0, INF, INF, INF, *[4.0] * 1072])
    assert utm.distances(scan, "MD", 361)[:4] == [3000, 1000, 1, 4000]


def test_too_far_and_too_near_are_codes(utm: Bench, urg: Bench, ust: Bench) -> None:
    for bench, far, near in ((utm, 1, 2), (ust, 65533, 2)):
        bench.ask("MD0000108001000")
        assert bench.distances(bench.turn([INF, 0.01, *[1.0] * 1079]), "MD", 1081)[:3] == [
            far,
            near,
            1000,
        ]
    urg.ask("MS0044072501000")
    scan = urg.turn([INF, 0.01, 4.5, 4.095, *[1.0] * 678])
    assert urg.distances(scan, "MS", 682)[:5] == [0, 19, 0, 4095, 1000]


def test_intensities_are_brighter_from_reflectors(utm: Bench) -> None:
    utm.ask("ME0000000101000")
    turn = utm.device.turn
    assert turn is not None
    lights = [0.9, 10.0, *[0.0] * 1079]
    sweep = Sweep(turn=turn, began=utm.now, ranges=[1.0] * 1081, intensities=lights)
    utm.device.measured(sweep, utm.now)
    lines = utm.read().rstrip("\n").encode().split(b"\n")
    readings = decode(lines[3:], FORMATS["ME"], 2)
    assert readings is not None
    assert 1000 < readings.intensities[0] < readings.intensities[1] < 1 << 18


def test_the_stamp_is_that_of_step_0(urg: Bench) -> None:
    urg.ask("MD0044072501000")
    began = urg.now
    turn = urg.device.turn
    assert turn is not None
    stamp = decode_stamp(urg.turn().split("\n")[2].encode())
    assert stamp == int((began - 44 * turn.beam_time) * 1000)


def test_a_slower_motor_makes_longer_turns(urg: Bench) -> None:
    urg.ask("CR10")
    urg.ask("MD0044072501000")
    turn = urg.device.turn
    assert turn is not None
    assert turn.period == pytest.approx(0.1 / 0.9)


def test_a_serial_line_carries_what_it_can() -> None:
    bench = Bench(ScipDevice(URG, scip1=False, start_speed=115200))
    bench.ask("MD0044072501000")
    turn = bench.device.turn
    assert turn is not None
    sweep = Sweep(turn=turn, began=bench.now, ranges=[1.5] * 682, intensities=[0.5] * 682)
    bench.device.measured(sweep, bench.now)
    bench.device.measured(sweep, bench.now + 0.1)  # still busy: left out
    early = bench.host.outgoing(bench.now + 0.1)
    assert len(early) == 1152
    late = bench.host.outgoing(bench.now + 0.3)
    assert (early + late).count(b"99b") == 1
    assert bench.device.deadline == INF


def test_the_speed_changes_after_the_answer_at_the_old_one(urg: Bench) -> None:
    urg.host.receive(b"SS115200\n", urg.now)
    assert urg.device.speed == 19200
    data = urg.host.outgoing(urg.now + 13 * 10 / 19200)
    assert data == b"SS115200\n00P\n"
    assert urg.device.speed == 19200
    assert urg.host.outgoing(urg.now + 0.1) == b"\n"
    assert urg.device.speed == 115200


def test_a_reset_gives_the_speed_back(urg: Bench) -> None:
    urg.ask("SS115200")
    urg.ask("CR05")
    assert urg.device.speed == 115200
    assert status(urg.ask("RS")) == "00"
    assert urg.device.speed == 19200
    assert status(urg.ask("CR00")) == "03"


def test_a_restart_takes_two_commands_and_some_time(ust: Bench) -> None:
    ust.ask("MD0540054001000")
    ust.host.receive(b"RB\nRB\n", ust.now)
    assert ust.host.outgoing(ust.now) == b"RB\n01Q\n\nRB\n00P\n\n"
    assert ust.device.turn is None
    ust.host.receive(b"VV\n", ust.now + 0.5)
    assert ust.host.outgoing(ust.now + 0.6) == b""
    ust.now += 1.0
    assert status(ust.ask("VV")) == "00"


def test_a_closed_connection_ends_its_own_stream_only() -> None:
    device = ScipDevice(UST)
    one, other = device.connect(), device.connect()
    one.receive(b"MD0540054001000\n", 0.0)
    other.receive(b"MD0540054001000\n", 0.0)
    one.close()
    assert device.turn is not None
    assert device.unit.laser_on
    other.close()
    assert device.turn is None
    assert not device.unit.laser_on


def test_a_serial_stream_outlives_its_host() -> None:
    device = ScipDevice(URG, scip1=False)
    host = device.connect()
    host.receive(b"MD0044072501000\n", 0.0)
    host.close()
    assert device.turn is not None
    assert device.connect() is host


def test_a_host_in_the_network_finds_a_serial_line_empty() -> None:
    device = ScipDevice(URG, scip1=True)
    host = device.connect(network=True)
    host.receive(b"PP\nQ", 0.0)
    again = Bench(device)
    again.host = device.connect(network=True)
    assert again.ask("QT") == "QT\n00P\n\n"


def test_a_scan_for_one_host_does_not_come_to_the_next() -> None:
    device = ScipDevice(URG, scip1=False)
    bench = Bench(device)
    bench.ask("BM")
    bench.ask("GD0044072501")
    device.connect(network=True)
    assert device.turn is None


def test_both_languages_serve_a_host_in_the_network() -> None:
    bench = Bench(ScipDevice(URG, scip1=True))
    bench.host = bench.device.connect(network=True)
    assert bench.ask("V").startswith("V\n0\nVEND:")
    assert bench.ask("L1") == "L1\n0\n\n"
    assert status(bench.ask("VV")) == "00"
    assert bench.ask("V").startswith("V\n0E")
    bench.device.switch_on(bench.now)
    bench.now += 2.0
    bench.host = bench.device.connect()
    assert bench.ask("QT") == "QT\nE\n\n"  # at a terminal it is as the real one


def test_a_laser_without_scip_2_knows_none_of_it_in_the_network_either() -> None:
    bench = Bench(ScipDevice(URG, scip2=False))
    bench.host = bench.device.connect(network=True)
    assert bench.ask("QT") == "QT\nE\n\n"


def test_a_network_host_that_does_not_read_costs_bounded_memory(utm: Bench) -> None:
    utm.ask("MD0000108001000")
    turn = utm.device.turn
    assert turn is not None
    sweep = Sweep(turn=turn, began=utm.now, ranges=[1.5] * 1081, intensities=[0.5] * 1081)
    for _ in range(100):
        utm.device.measured(sweep, utm.now)
    assert len(utm.host.outgoing(utm.now)) < 150_000


# Programs of others, as scip.md 7 tells it.


def test_hokuyo_node_finds_what_it_expects() -> None:
    bench = Bench(ScipDevice(UTM))
    bench.ask("TM2")
    assert bench.ask("RS") == bench.ask("RS") == "RS\n00P\n\n"
    parameters = bench.ask("PP").split("\n")
    assert len(parameters) == 12
    assert [line[:5] for line in parameters[2:10]] == [
        f"{key}:" for key in ["MODL", "DMIN", "DMAX", "ARES", "AMIN", "AMAX", "AFRT", "SCAN"]
    ]
    version = bench.ask("VV").split("\n")
    assert [line[:5] for line in version[2:7]] == ["VEND:", "PROD:", "FIRM:", "PROT:", "SERI:"]
    assert "STAT:Sensor works well.;" in bench.ask("II")
    assert status(bench.ask("BM")) == "00"
    for _ in range(3):
        assert bench.ask("TM0") == "TM0\n00P\n\n"
        assert len(bench.ask("TM1")) == 15
        assert bench.ask("TM2") == "TM2\n00P\n\n"
    bench.ask("BM")
    assert bench.ask("GD0180090001") == ""
    polled = bench.turn()
    assert polled.startswith("GD0180090001\n00P\n")
    assert bench.distances(polled, "GD", 721) == [1500] * 721
    assert bench.ask("ME0180090001000") == "ME0180090001000\n00P\n\n"
    assert bench.turn().startswith("ME0180090001000\n99b\n")
    assert bench.ask("QT") == "QT\n00P\n\n"
    assert bench.device.turn is None


def test_urg_c_finds_what_it_expects() -> None:
    bench = Bench(ScipDevice(UST, status="Stable 000 no error."))
    assert bench.ask("QT") == "QT\n00P\n\n"
    bench.ask("TM0")
    assert bench.ask("QT").split("\n")[1] == "0Ee"
    bench.ask("TM2")
    assert len(bench.ask("PP").removesuffix("\n\n").split("\n")) == 10
    assert len(bench.ask("II").removesuffix("\n\n").split("\n")) >= 9
    assert "STAT:Stable" in bench.ask("II")
    assert bench.ask("BM").split("\n")[1] in {"00P", "02R"}
    bench.ask("GD0000108001")
    single = bench.turn()
    assert single.split("\n")[1] == "00P"
    assert bench.ask("MD0000108001005").split("\n")[1] == "00P"
    scans = [bench.turn().split("\n") for _ in range(5)]
    assert [scan[0][-2:] for scan in scans] == ["04", "03", "02", "01", "00"]
    assert {len(scan[0]) for scan in scans} == {15}
    assert all(len(line) <= 65 for scan in scans for line in scan)


def test_aria_finds_what_it_expects_of_scip_2() -> None:
    bench = Bench(ScipDevice(URG, scip1=False))
    bench.ask("RS")
    bench.ask("SCIP2.0")
    for key in ("VEND:", "PROD:", "FIRM:", "PROT:", "SERI:"):
        assert f"\n{key}" in bench.ask("VV")
    bench.ask("SS115200")
    assert bench.device.speed == 115200
    pairs = from_pairs(bench.ask("PP").encode().strip(b"\n").split(b"\n")[2:])
    assert pairs is not None
    assert all(int(value) > 0 for key, value in pairs.items() if key != "MODL")
    assert bench.ask("MD0044072503000").endswith("\n\n")
    scan = bench.turn().split("\n")
    assert scan[:2] == ["MD0044072503000", "99b"]
    assert len(scan[2]) == 5
    bench.ask("RS")
    assert bench.device.turn is None
    assert status(bench.ask("SS019200")) == "03"


def test_aria_finds_what_it_expects_of_scip_1() -> None:
    bench = Bench(ScipDevice(URG, scip1=True))
    bench.ask("S0576007654321")
    assert bench.device.speed == 57600
    version = bench.ask("V").split("\n")
    assert version[:2] == ["V", "0"]
    assert [line[:5] for line in version[2:-2]] == [
        f"{key}:" for key in ["VEND", "PROD", "FIRM", "PROT", "SERI", "STAT"]
    ]
    assert bench.ask("G00076803") == ""
    scan = bench.turn()
    assert scan.startswith("G00076803\n0\n")
    distances = bench.distances(scan, "G", 257)
    assert distances[20:200] == [1500] * 180
    assert distances[0] == 0  # beyond the field
    assert bench.ask("X") == "X\nE\n\n"
    assert bench.ask("QT") == "QT\nE\n\n"
    assert bench.ask("L0") == "L0\n0\n\n"
    assert bench.ask("G04472501") == "G04472501\n1\n\n"
    assert bench.ask("S0192007654321") == "S0192007654321\n0\n\n"
    assert bench.device.speed == 19200


def test_the_first_firmware_does_not_know_scip_2() -> None:
    bench = Bench(ScipDevice(URG, scip2=False))
    assert bench.ask("SCIP2.0") == "SCIP2.0\nE\n\n"
    newer = Bench(ScipDevice(URG, scip1=True))
    assert newer.ask("SCIP2.0") == "SCIP2.0\n0\n\n"
    assert newer.ask("VV").startswith("VV\n00P\n")


def test_every_model_in_the_table_turns() -> None:
    for model in LASERS.values():
        if model.steps is None:
            continue
        bench = Bench(ScipDevice(model, scip1=False))
        bench.ask(f"MD{model.steps.first:04}{model.steps.last:04}01000")
        turn: MirrorTurn | None = bench.device.turn
        assert turn is not None
        assert turn.count == model.count
        assert turn.period == pytest.approx(model.turn)
        assert turn.first + (turn.count - 1) * turn.step == pytest.approx(model.last)
        assert bench.distances(bench.turn(), "MD", model.count) == [1500] * model.count
