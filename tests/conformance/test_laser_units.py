"""Simulated lasers as other programs use them: the serial LMS-2xx and the network's CoLa-A lasers.

Each test is a rule that these programs need (lms2xx.md 2.1, 2.2; cola.md 5); hosts are at real
pseudo terminals and real sockets.
"""

import asyncio
import termios
import time
from struct import unpack

import pytest

from pioneer3.lasers.lms2xx.telegram import encode
from pioneer3.sim.server import laser_hosts
from tests.conformance.laser_hosts import BOOT, PATIENCE, LmsHost, NetworkHost, simulated
from tests.support import until

pytestmark = pytest.mark.realtime
Patch = pytest.MonkeyPatch
SPEEDS = {9600: 0x42, 19200: 0x41, 38400: 0x40}
LOGIN = "sMN SetAccessMode 3 F4724744"


async def faster(host: LmsHost, baud: int = 38400, when: int = termios.TCSANOW) -> None:
    """Change the speed of laser and host."""
    assert await host.ask(0x20, bytes((SPEEDS[baud],))) == b"\x00"
    host.set_speed(baud, when)
    host.flush()


def values(body: bytes) -> tuple[int, ...]:
    """Return the values of a scan."""
    (header,) = unpack("<H", body[:2])
    assert len(body) == 2 + 2 * (header & 0x3FF)
    return unpack(f"<{header & 0x3FF}H", body[2:])


async def test_lms_only_a_host_at_its_speed_is_heard_and_others_hear_rubbish(
    monkeypatch: Patch,
) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty, 19200)
        host.write(encode(0x31))
        assert await host.listen(0.3) == b""
        host.set_speed(9600)
        assert len(await host.ask(0x31)) == 152
        assert await host.ask(0x20, b"\x24") == b"\x00"
        host.set_speed(38400)
        await host.listen(0.1)
        assert b"\x02\x80" not in await host.listen(0.3)
        host.close()


async def test_lms_requests_may_come_byte_by_byte_with_pauses(monkeypatch: Patch) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        await host.write_slowly(encode(0x3A), 55e-6)
        assert (await host.until(b"LMS200;"))[:6] == bytes.fromhex("06 02 80 17 00 BA")
        await host.listen(0.1)
        host.flush()
        await host.write_slowly(encode(0x32), 0.006)
        await host.until(bytes.fromhex("06 02 80 02 00 B2 10 3F 13"))
        host.close()


async def test_lms_a_spoilt_request_is_refused_and_an_unknown_one_too(monkeypatch: Patch) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        host.write(encode(0x31)[:-1] + b"\xff")
        await host.until(b"\x15")
        host.write(encode(0x55))
        await host.until(bytes.fromhex("06 02 80 02 00 92 10 7F 33"))
        host.close()


@pytest.mark.parametrize("when", [termios.TCSANOW, termios.TCSADRAIN, termios.TCSAFLUSH])
@pytest.mark.parametrize("baud", [19200, 38400])
async def test_lms_the_answer_comes_at_the_old_speed_however_hosts_change_theirs(
    monkeypatch: Patch, baud: int, when: int
) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        await faster(host, baud, when)
        assert await host.ask(0x32) == b""
        assert laser.device.speed == baud
        host.close()


async def test_lms_a_host_may_change_its_speed_without_waiting_for_the_answer(
    monkeypatch: Patch,
) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        host.write(encode(0x20, b"\x40"))
        await asyncio.sleep(0.02)
        host.set_speed(38400)
        await asyncio.sleep(0.3)
        assert await host.ask(0x3B, bytes.fromhex("B4 00 64 00")) == bytes.fromhex("01B4006400")
        host.close()


async def test_lms_a_host_may_leave_at_the_speed_that_it_came_with(monkeypatch: Patch) -> None:
    monkeypatch.setattr(laser_hosts, "LANDING", PATIENCE)  # however late the kernel is
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        await faster(host)
        await host.listen(0.1)
        host.write(encode(0x20, b"\x42"))
        host.set_speed(9600, termios.TCSADRAIN)
        host.close()
        await until(lambda: laser.device.speed == 9600)


async def test_lms_a_reset_is_followed_by_silence_and_ready_at_9600(monkeypatch: Patch) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        await faster(host)
        host.write(encode(0x10))
        await host.until(bytes.fromhex("02 80 02 00 91 10 79 30"))
        reset_at = time.monotonic()
        host.set_speed(9600)
        host.write(encode(0x31))  # it is deaf while it starts
        ready = await host.answer(0x90)
        assert ready.body.startswith(b"LMS200;")
        assert time.monotonic() - reset_at > BOOT / 2
        host.close()


async def test_lms_power_comes_back_with_silence_and_ready(monkeypatch: Patch) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        await faster(host)
        laser.switch_off()
        host.write(encode(0x31))
        assert await host.listen(0.2) == b""
        laser.switch_on()
        host.set_speed(9600)
        assert (await host.answer(0x90)).body.startswith(b"LMS200;")
        host.close()


async def test_lms_modes_guard_the_requests_that_need_them(monkeypatch: Patch) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        await faster(host)
        host.write(encode(0x77, bytes(32)))
        await host.answer(0x92)
        assert await host.ask(0x20, b"\x00SICK_XXX") == b"\x01"
        assert await host.ask(0x20, b"\x00SICK_LMS") == b"\x00"
        host.write(encode(0x30, b"\x01"))
        await host.answer(0x92)
        assert (await host.ask(0x3B, bytes.fromhex("B4 00 19 00")))[:1] == b"\x00"
        assert await host.ask(0x20, b"\x25") == b"\x00"
        assert len(values(await host.ask(0x30, b"\x01"))) == 361
        host.close()


async def test_lms_a_stream_outlives_its_host_and_takes_variants_and_stops(
    monkeypatch: Patch,
) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        first = LmsHost(laser.pty)
        await faster(first)
        assert await first.ask(0x20, b"\x24") == b"\x00"
        await first.answer(0xB0)
        first.close()
        await asyncio.sleep(0.3)
        host = LmsHost(laser.pty, 38400)
        host.flush()
        await host.answer(0xB0)
        assert (await host.ask(0x3B, bytes.fromhex("64 00 64 00")))[:1] == b"\x01"
        assert len(values((await host.answer(0xB0)).body)) == 101
        assert await host.ask(0x20, b"\x25") == b"\x00"
        await host.listen(0.2)
        assert await host.listen(0.3) == b""
        host.close()


@pytest.mark.parametrize("sent", [7, 32, 34])
async def test_lms_a_configuration_may_be_short_and_outlives_the_power(
    monkeypatch: Patch, sent: int
) -> None:
    block = bytes.fromhex("00 00 46 00 00 05 01 00 00 02 02").ljust(34, b"\0")[:sent]
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        await faster(host)
        assert await host.ask(0x20, b"\x00SICK_LMS") == b"\x00"
        written = await host.ask(0x77, block)
        assert (written[0], len(written)) == (1, 35)
        assert written[1 : 1 + sent] == block
        assert (await host.ask(0x3B, bytes.fromhex("B4 00 64 00")))[:1] == b"\x01"
        laser.switch_off()
        laser.switch_on()
        host.set_speed(9600)
        await host.answer(0x90)
        assert await host.ask(0x74) == written[1:]
        status = b"\xb1" + await host.ask(0x31)
        assert unpack("<HH", status[107:111]) == (180, 50)
        host.close()


async def test_lms_scans_come_as_fast_as_the_line_carries_them_and_without_zeros(
    monkeypatch: Patch,
) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        await faster(host)
        await host.ask(0x3B, bytes.fromhex("B4 00 64 00"))
        await host.ask(0x20, b"\x00SICK_LMS")
        await host.ask(0x77, bytes.fromhex("00 00 46 00 00 05 01").ljust(32, b"\0"))
        assert await host.ask(0x20, b"\x24") == b"\x00"
        await host.answer(0xB0)
        began = time.monotonic()
        scans = [values((await host.answer(0xB0)).body) for _ in range(10)]
        assert time.monotonic() - began > 0.8  # 97 ms each
        assert {len(scan) for scan in scans} == {181}
        assert all(0 < value <= 32759 for scan in scans for value in scan)
        host.close()


async def test_lms_scans_are_whole_though_the_host_pauses(monkeypatch: Patch) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        assert await host.ask(0x20, b"\x48") == b"\x00"
        host.set_speed(500000)
        assert await host.ask(0x20, b"\x24") == b"\x00"
        rejected = host.reader.rejected
        await asyncio.sleep(1.5)
        for _ in range(50):
            assert len(values((await host.answer(0xB0)).body)) == 361
        assert host.reader.rejected == rejected
        host.close()


async def test_lms_turns_are_sent_apart_as_partial_scans(monkeypatch: Patch) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        assert laser.pty is not None
        host = LmsHost(laser.pty)
        await faster(host)
        assert await host.ask(0x20, b"\x2a") == b"\x00"
        headers = {(await host.answer(0xB0)).body[:2].hex() for _ in range(4)}
        assert headers == {"b520", "b430"}  # cm, as delivered
        host.close()


async def test_lms_a_last_request_over_the_network_is_obeyed(monkeypatch: Patch) -> None:
    async with simulated("lms-200", monkeypatch) as laser:
        host = await NetworkHost.connect(laser)
        host.writer.write(encode(0x20, b"\x24"))
        await host.until(b"\xb0")
        host.writer.write(encode(0x20, b"\x25"))
        await host.close()
        await until(lambda: laser.device.turn is None)


async def test_cola_both_ports_serve_several_hosts_with_streams_of_their_own() -> None:
    async with simulated("lms-111") as laser:
        hosts = [await NetworkHost.connect(laser, -1) for _ in range(3)]
        for host in hosts[:2]:
            assert await host.cola("sEN LMDscandata 1") == "sEA LMDscandata 1"
            assert (await host.telegram()).startswith("sSN LMDscandata 1 1 ")
        assert await hosts[2].cola("sRN STlms") != ""
        assert [p.count(b"sSN") for p in hosts[2].pieces] == [0]
        await hosts[0].close()
        assert (await hosts[1].telegram()).startswith("sSN LMDscandata")
        for host in hosts[1:]:
            await host.close()


async def test_cola_requests_may_come_one_byte_every_100_ms() -> None:
    async with simulated("lms-111") as laser:
        host = await NetworkHost.connect(laser)
        for byte in b"\x02sRN STlms\x03":
            host.writer.write(bytes((byte,)))
            await asyncio.sleep(0.1)
        assert (await host.telegram()).startswith("sRA STlms 7 0 8 ")
        await host.close()


async def test_cola_each_answer_is_one_segment_before_any_scan() -> None:
    async with simulated("lms-111") as laser:
        host = await NetworkHost.connect(laser)
        for request, answer in (
            (LOGIN, "sAN SetAccessMode 1"),
            (
                "sMN mLMPsetscancfg +2500 +1 +2500 -450000 +2250000",
                "sAN mLMPsetscancfg 0 9C4 1 9C4 FFF92230 225510",
            ),
            ("sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +1", "sWA LMDscandatacfg"),
            ("sMN LMCstartmeas", "sAN LMCstartmeas 0"),
            ("sMN mEEwriteall", "sAN mEEwriteall 1"),
            ("sMN Run", "sAN Run 1"),
            ("sRN Nonsense", "sFA 3"),
            ("sEN LMDscandata 1", "sEA LMDscandata 1"),
        ):
            assert await host.cola(request) == answer
            piece, told = host.pieces.pop(), f"\x02{answer}\x03".encode()
            if "LMDscandata 1" in request:  # a busy computer reads the first scan with it
                assert piece.startswith(told)
            else:
                assert piece == told
        assert len(await host.telegram()) < 12_000
        await host.close()


@pytest.mark.parametrize(
    ("name", "count", "start"),
    [("lms-111", 541, "FFF92230"), ("lms-511", 381, "FFFF3CB0"), ("tim551", 271, "FFF92230")],
)
async def test_cola_scans_have_the_words_that_programs_count_on(
    name: str, count: int, start: str
) -> None:
    async with simulated(name) as laser:
        host = await NetworkHost.connect(laser)
        assert await host.cola("sEN LMDscandata 1") == "sEA LMDscandata 1"
        words = (await host.telegram()).split(" ")
        assert words[15] == "0"
        assert words[20:22] == ["DIST1", "40000000" if name == "lms-511" else "3F800000"]
        assert words[23] == start
        assert int(words[25], 16) == count
        assert words[26 + count :] == ["0"] * 6
        assert sum(map(len, words)) + len(words) < 10_000
        await host.close()


async def test_cola_after_sen_0_comes_nothing_but_its_answer() -> None:
    async with simulated("tim551") as laser:
        host = await NetworkHost.connect(laser)
        assert await host.cola("sEN LMDscandata 1") == "sEA LMDscandata 1"
        await host.telegram()
        host.writer.write(b"\x02sEN LMDscandata 0\x03")
        while await host.telegram() != "sEA LMDscandata 0":
            pass
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.3):
                await host.telegram()
        assert (await host.cola("sRN LMDscandata")).startswith("sRA LMDscandata ")
        await host.close()


async def test_cola_settings_outlive_hosts_but_not_the_power_unless_stored() -> None:
    async with simulated("lms-511") as laser:
        host = await NetworkHost.connect(laser)
        await host.cola(LOGIN)
        await host.cola("sMN mLMPsetscancfg +7500 +1 +10000 -50000 +1850000")
        await host.close()
        again = await NetworkHost.connect(laser)
        wanted = "sRA LMPscancfg 1D4C 1 2710 FFFF3CB0 1C3A90"
        assert await again.cola("sRN LMPscancfg") == wanted
        laser.switch_off()
        laser.switch_on()
        other = await NetworkHost.connect(laser)
        assert await other.cola("sRN LMPscancfg") != wanted
        assert await other.cola("sRN STlms") < "sRA STlms 7"  # its mirror is not up to speed yet
        await other.close()
        await again.close()


async def test_cola_a_host_that_leaves_at_once_is_obeyed() -> None:
    async with simulated("lms-511") as laser:
        host = await NetworkHost.connect(laser)
        change = "sMN mLMPsetscancfg +7500 +1 +10000 -50000 +1850000"
        host.writer.write(f"\x02{LOGIN}\x03\x02{change}\x03".encode())
        await host.close()
        await asyncio.sleep(0.2)
        other = await NetworkHost.connect(laser)
        assert (await other.cola("sRN LMPscancfg")).startswith("sRA LMPscancfg 1D4C ")
        await other.close()
