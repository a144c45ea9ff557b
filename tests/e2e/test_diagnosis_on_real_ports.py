"""The doctor on real sockets and pseudo terminals."""

import asyncio
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from random import Random

import pytest

from pioneer3.doctor.diagnose import diagnose, exit_code, gather
from pioneer3.doctor.facts import Level
from pioneer3.doctor.ports import holders_of
from pioneer3.doctor.probe import ProbeVerdict, probe
from pioneer3.doctor.probe_session import QUICK
from pioneer3.sim.server.start import simulator
from tests.pseudo_terminal import PtyPort, open_pty

pytestmark = pytest.mark.realtime


@asynccontextmanager
async def server(greeting: bytes = b"", *, hang_up: bool = False) -> AsyncIterator[str]:
    """Run a TCP server that says `greeting` and answers nothing; yield its URL."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(greeting)
        while not hang_up and await reader.read(1000):
            pass
        writer.close()

    listening = await asyncio.start_server(serve, "127.0.0.1", 0)
    async with listening:
        yield f"tcp://127.0.0.1:{listening.sockets[0].getsockname()[1]}"


@asynccontextmanager
async def pty_laser() -> AsyncIterator[PtyPort]:
    """Run a SCIP laser that knows its version only."""
    port = await open_pty()

    async def serve() -> None:
        line = b""
        while data := await port.link.read():
            line += data
            while b"\n" in line:
                command, _, line = line.partition(b"\n")
                if command == b"VV":
                    await port.link.write(b"VV\n00P\nVEND:Hokuyo;x\nPROD:UBG-04LX;x\n\n")
                elif command:
                    await port.link.write(command + b"\n0E\n\n")

    serving = asyncio.ensure_future(serve())
    try:
        yield port
    finally:
        serving.cancel()
        await port.close()


async def test_a_simulator_on_tcp_passes() -> None:
    async with simulator(port=0) as simulated:
        findings = diagnose(await gather(simulated.url, seconds=1.0))
    assert exit_code(findings) == 0
    assert Level.FAIL not in {finding.level for finding in findings}


async def test_a_second_host_is_told_that_another_program_is_connected() -> None:
    async with simulator(port=0) as simulated:
        host, _, port = simulated.url.removeprefix("tcp://").partition(":")
        _, writer = await asyncio.open_connection(host, int(port))
        try:
            await asyncio.sleep(0.1)
            facts = await gather(simulated.url, seconds=0.1)
        finally:
            writer.close()
    assert facts.closed
    assert exit_code(diagnose(facts)) == 3


async def test_a_refused_connection_is_not_reachable() -> None:
    async with server() as url:
        pass
    findings = diagnose(await gather(url))
    assert exit_code(findings) == 3
    assert "nobody listens" in findings[0].found


async def test_an_unknown_host_is_not_reachable() -> None:
    findings = diagnose(await gather("tcp://no-such-robot.invalid:8101"))
    assert exit_code(findings) == 3


async def test_a_web_server_is_no_robot() -> None:
    async with server(b"HTTP/1.1 400 Bad Request\r\n\r\n", hang_up=True) as url:
        found = await probe(url, timing=QUICK)
    assert found.verdict is ProbeVerdict.OTHER
    assert "HTTP/1.1 400 Bad Request" in found.detail


async def test_garbage_is_no_robot() -> None:
    async with server(Random(1).randbytes(300)) as url:
        found = await probe(url, timing=QUICK)
    assert found.verdict is ProbeVerdict.OTHER


async def test_a_laser_on_a_serial_port_is_recognised() -> None:
    async with pty_laser() as port:
        found = await probe(port.path, timing=QUICK)
    assert (found.verdict, found.detail) == (ProbeVerdict.LASER, "Hokuyo, UBG-04LX")


async def test_a_silent_serial_port_is_silent() -> None:
    port = await open_pty()
    try:
        found = await probe(port.path, timing=QUICK)
    finally:
        await port.close()
    assert found.verdict is ProbeVerdict.SILENT


async def test_a_port_that_another_process_has_open_is_left_alone() -> None:
    port = await open_pty()
    rival = await asyncio.create_subprocess_exec("sleep", "60", stdin=_opened(port.path))
    try:
        assert [holder.name for holder in holders_of(port.path)] == ["sleep"]
        findings = diagnose(await gather(port.path))
    finally:
        rival.kill()
        await rival.wait()
        await port.close()
    assert [finding.check for finding in findings] == ["port"]
    assert f"sleep (process {rival.pid})" in findings[0].found


async def test_no_such_port_is_not_reachable() -> None:
    assert exit_code(diagnose(await gather("/dev/no-such-port"))) == 3


def _opened(path: str) -> int:
    return os.open(path, os.O_RDWR | os.O_NOCTTY)
