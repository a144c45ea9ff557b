"""Simulated Hokuyo lasers as other programs use them, at real terminals and sockets (scip.md 7)."""

import asyncio
from itertools import pairwise

import pytest

from pioneer3.lasers.scip.wire import checksum, decode_stamp, unseal
from tests.conformance.laser_hosts import NetworkHost, Terminal, simulated

pytestmark = pytest.mark.realtime
END = b"\n\n"
NEEDED = ["VEND", "PROD", "FIRM", "PROT", "SERI"]
GEOMETRY = ["MODL", "DMIN", "DMAX", "ARES", "AMIN", "AMAX", "AFRT", "SCAN"]


async def ask(host: Terminal, command: str) -> list[bytes]:
    """Return the lines of the answer to a command, from its echo on."""
    host.write(command.encode() + b"\n")
    answer = await host.until(END)
    return answer[answer.rindex(command.encode() + b"\n") : -2].split(b"\n")


def numbers(lines: list[bytes]) -> dict[str, int]:
    """Return the geometry in an answer to PP; each line has its checksum."""
    assert lines[1] == b"00P"
    assert [line[:4].decode() for line in lines[2:]] == GEOMETRY
    assert all(line[-1] == checksum(line[:-2]) for line in lines[2:])
    return {line[:4].decode(): int(line[5:-2]) for line in lines[3:]}


def check_scan(scan: bytes, command: str, width: int) -> int:
    """Check echo, status, stamp and lines of a streamed scan; return its stamp [ms]."""
    echo, status, stamp, *data = scan.removesuffix(END).split(b"\n")
    assert (echo[:13].decode(), status) == (command[:13], b"99b")
    texts = [unseal(line) for line in data]
    assert None not in texts
    assert all(len(line) == 65 for line in data[:-1])
    first, last, cluster = int(command[2:6]), int(command[6:10]), max(int(command[10:12]), 1)
    count = (last - first) // cluster + 1
    assert sum(len(line) - 1 for line in data) == width * count
    milliseconds = decode_stamp(stamp)
    assert milliseconds is not None
    return milliseconds


@pytest.mark.parametrize("name", ["urg-04lx", "ubg-04lx-f01"])
@pytest.mark.parametrize(("baud", "letters", "width"), [(19200, "MS", 2), (115200, "MD", 3)])
async def test_aria_starts_and_leaves_in_scip_2(
    name: str, baud: int, letters: str, width: int
) -> None:
    async with simulated(name) as laser:
        assert laser.pty is not None
        host = Terminal(laser.pty, 19200)
        for sent in (b"RS\n", b"SCIP2.0\n"):
            host.write(sent)
            await asyncio.sleep(0.1)
        await host.listen(1.0)
        host.flush()
        version = await ask(host, "VV")
        assert [line[:4].decode() for line in version[2:]] == NEEDED
        if baud != 19200:
            assert (await ask(host, f"SS{baud:06}"))[1] == b"00P"
            host.set_speed(baud)
            assert [line[:4].decode() for line in (await ask(host, "VV"))[2:]] == NEEDED
        geometry = numbers(await ask(host, "PP"))
        assert all(geometry.values())  # ARIA takes no 0
        await asyncio.sleep(0.1)
        command = f"{letters}{geometry['AMIN']:04}{geometry['AMAX']:04}03000"
        assert await ask(host, command) == [command.encode(), b"00P"]
        stamps = [check_scan(await host.until(END), command, width) for _ in range(3)]
        assert all(0 < later - one < 1000 for one, later in pairwise(stamps))
        host.write(b"RS\n")
        await host.until(b"RS\n00P\n\n")
        host.set_speed(19200)
        await asyncio.sleep(0.1)
        host.flush()
        assert (await ask(host, "SS019200"))[1] == b"03S"
        assert laser.device.turn is None
        host.close()


async def test_aria_starts_and_leaves_in_scip_1() -> None:
    async with simulated("urg-04lx") as laser:
        assert laser.pty is not None
        host = Terminal(laser.pty, 19200)
        assert await ask(host, "S0576007654321") == [b"S0576007654321", b"0"]
        host.close()
        host = Terminal(laser.pty, 57600)
        version = await ask(host, "V")
        assert [line[:4].decode() for line in version[2:]] == [*NEEDED, "STAT"]
        for _ in range(3):
            echo, status, *data = await ask(host, "G00076803")
            assert (echo, status) == (b"G00076803", b"0")
            assert sum(map(len, data)) == 2 * 257
        assert await ask(host, "S0192007654321") == [b"S0192007654321", b"0"]
        host.close()
        host = Terminal(laser.pty, 19200)
        assert (await ask(host, "V"))[1] == b"0"
        host.close()


@pytest.mark.parametrize(
    ("name", "baud", "zero"),
    [("urg-04lx", 19200, False), ("urg-04lx-ug01", 115200, False), ("utm-30lx", 115200, True)],
)
async def test_hokuyo_node_starts_measures_and_leaves(name: str, baud: int, zero: bool) -> None:
    async with simulated(name) as laser:
        assert laser.pty is not None
        host = Terminal(laser.pty, baud)

        async def command(text: str) -> list[bytes]:
            host.flush()
            return await ask(host, text)

        await command("TM2")
        if (await command("RS"))[1] == b"E":
            await command("SCIP2.0")
        assert await command("RS") == [b"RS", b"00P"]
        geometry = numbers(await command("PP"))
        assert (geometry["AMIN"] == 0) is zero
        assert (await command("VV"))[1] == b"00P"
        assert any(line.startswith(b"STAT:Sensor works well.;") for line in await command("II"))
        assert await command("BM") == [b"BM", b"00P"]
        for _ in range(3):
            assert (await command("TM0"))[1] == b"00P"
            stamp = await command("TM1")
            assert decode_stamp(stamp[2]) is not None
            assert (await command("TM2"))[1] == b"00P"
            assert (await command("BM"))[1] in {b"00P", b"02R"}
            assert (await command("GD0384038401"))[1] == b"00P"
        stream = f"MD{geometry['AFRT'] - 100:04}{geometry['AFRT'] + 100:04}01000"
        assert await command(stream) == [stream.encode(), b"00P"]
        stamps = [check_scan(await host.until(END), stream, 3) for _ in range(4)]
        assert all(later > one for one, later in pairwise(stamps))
        host.flush()
        host.write(b"QT\n")
        await host.until(b"QT\n00P\n\n")
        assert await host.listen(0.3) == b""
        host.close()


async def test_urg_c_hunts_for_the_speed_and_the_state() -> None:
    async with simulated("urg-04lx") as laser:
        assert laser.pty is not None
        host = Terminal(laser.pty, 115200)
        heard = {}
        for baud in (115200, 38400, 19200):
            host.set_speed(baud)
            host.flush()
            host.write(b"QT\n")
            heard[baud] = await host.listen(0.3)
        assert heard == {115200: b"", 38400: b"", 19200: b"QT\nE\n\n"}
        host.flush()
        await ask(host, "SCIP2.0")
        assert await ask(host, "TM0") == [b"TM0", b"00P"]
        assert await ask(host, "QT") == [b"QT", b"0Ee"]
        assert await ask(host, "TM2") == [b"TM2", b"00P"]
        assert await ask(host, "QT") == [b"QT", b"00P"]
        assert len(await ask(host, "PP")) == 10
        assert len(await ask(host, "II")) >= 9
        host.close()


async def test_urg_c_on_ethernet_counts_the_scans_down() -> None:
    async with simulated("ust-10lx") as laser:
        host = await NetworkHost.connect(laser)
        for sent, answer in (
            (b"QT\n", b"QT\n00P\n\n"),
            (b"SS115200\n", b"SS115200\n0Ff\n\n"),
            (b"BM\n", b"BM\n00P\n\n"),
            (b"MD0000108001005\n", b"MD0000108001005\n00P\n\n"),
        ):
            host.writer.write(sent)
            assert await host.until(END) == answer
        scans = [await host.until(END) for _ in range(5)]
        assert [scan[13:15] for scan in scans] == [b"04", b"03", b"02", b"01", b"00"]
        for scan in scans:
            check_scan(scan, "MD0000108001005", 3)
        host.writer.write(b"QT\n")
        assert await host.until(END) == b"QT\n00P\n\n"
        await host.close()


async def test_urg_c_gets_scans_in_the_network_from_a_laser_on_a_serial_line() -> None:
    command = "MS0044072503000"
    async with simulated("urg-04lx") as laser:
        for _ in range(3):
            host = await NetworkHost.connect(laser)
            host.writer.write(b"QT\n")  # to which urg_c takes no status without a checksum
            while (heard := await host.until(END)) != b"QT\n00P\n\n":
                assert heard.startswith(command.encode())  # the stream goes on, in whole scans
            host.writer.write(b"PP\n")
            assert (await host.until(END)).startswith(b"PP\n00P\nMODL:URG-04LX;9\n")
            host.writer.write(command.encode() + b"\n")
            assert await host.until(END) == command.encode() + b"\n00P\n\n"
            check_scan(await host.until(END), command, 2)
            await host.close()


@pytest.mark.parametrize("name", ["utm-30lx", "urg-04lx"])
async def test_hokuyo_node_gets_whole_scans_though_it_pauses(name: str) -> None:
    async with simulated(name) as laser:
        assert laser.pty is not None
        host = Terminal(laser.pty, 19200)
        if laser.device.speed is not None:
            await ask(host, "SCIP2.0")
            await ask(host, "SS500000")
            host.set_speed(500000)
        geometry = numbers(await ask(host, "PP"))
        command = f"MD{geometry['AMIN']:04}{geometry['AMAX']:04}01000"
        await ask(host, command)
        for pause in (0.2, 1.5, 0.2):
            await asyncio.sleep(pause)
            for _ in range(10):
                check_scan(await host.until(END), command, 3)
        host.close()
