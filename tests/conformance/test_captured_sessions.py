"""Sessions of real ARIA programs with a real simulator, played to each of our two ends."""

import asyncio
from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest

from pioneer3 import connect_async
from pioneer3.arcos import commands, reports
from pioneer3.arcos.device import Commanded, Device, SessionClosed, SessionOpened
from pioneer3.arcos.host import Host
from pioneer3.arcos.host_events import Configured, Opened, ReportReceived, Timing
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.links.tap import FROM_HOST, FROM_ROBOT, Chunk, read_recording
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.world import World
from pioneer3.state import Identity

FOLDER = Path(__file__).parents[2].parent / "shared" / "captures"
CAPTURES = sorted(FOLDER.glob("*.txt"))
SIMPLE = FOLDER / "aria291-simpleConnect.txt"
AMRISIM = Identity(name="AMRISim", family="Pioneer", model="p3at")
CYCLE = 0.1

pytestmark = pytest.mark.skipif(not CAPTURES, reason="no captures beside this checkout")
each = pytest.mark.parametrize("capture", CAPTURES, ids=lambda path: path.stem)


def way(capture: Path, which: str) -> list[Chunk]:
    return [chunk for chunk in read_recording(capture) if chunk.way == which]


def payloads(chunks: list[Chunk]) -> list[bytes]:
    return PacketReader().feed(b"".join(chunk.data for chunk in chunks))


@each
def test_our_device_understands_every_session_of_aria(capture: Path) -> None:
    said = way(capture, FROM_HOST)
    device, events, answers = Device(AMRISIM), [], b""
    for chunk in said:
        events += device.receive(chunk.data, chunk.time)
        answers += device.outgoing()
    asked = [commands.from_payload(payload) for payload in payloads(said)]
    assert answers == b"".join(c.data for c in way(capture, FROM_ROBOT)[:3])  # byte for byte
    assert events[0] == SessionOpened()
    assert events[-1] == SessionClosed()
    silent = (commands.Pulse, commands.Open, commands.Close)
    expected = [Commanded(c) for c in asked[4:] if not isinstance(c, silent)]
    assert [e for e in events if isinstance(e, Commanded)] == expected
    assert not device.is_open


def played_to_firmware(capture: Path) -> list[tuple[float, reports.Report]]:
    """Return what our simulated robot answers to a captured program, and when."""
    said = way(capture, FROM_HOST)
    body = Body(load_model("p3at"))
    world = World(None, [body])
    firmware = Firmware(world, body, name="AMRISim")
    answers: list[tuple[float, reports.Report]] = []
    reader, step, end = PacketReader(), 0, said[-1].time + 1.0
    while (now := step * 0.02) < end:
        while said and said[0].time <= now:
            firmware.receive(said.pop(0).data, now)
        world.step(0.02)
        firmware.tick(now)
        sent = reader.feed(firmware.device.outgoing(), now)
        answers += [(now, reports.from_payload(payload)) for payload in sent]
        step += 1
    assert not firmware.device.is_open
    assert not body.drive.powered
    return answers


@each
def test_our_simulated_robot_serves_every_session_of_aria(capture: Path) -> None:
    answers = played_to_firmware(capture)
    first = [report for _, report in answers[:3]]
    assert first[:2] == [reports.SyncEcho(0), reports.SyncEcho(1)]
    assert first[2] == reports.SyncIdentity("AMRISim", "Pioneer", "p3at")
    kinds = Counter(type(report) for _, report in answers)
    requested = [commands.from_payload(payload) for payload in payloads(way(capture, FROM_HOST))]
    assert kinds[reports.Config] == requested.count(commands.RequestConfig())
    theirs = Counter(
        type(reports.from_payload(payload)) for payload in payloads(way(capture, FROM_ROBOT))
    )
    assert set(theirs) <= set(kinds)
    at = [time for time, report in answers if isinstance(report, reports.Sip)]
    gaps = [after - before for before, after in pairwise(at)]
    assert all(gap == pytest.approx(CYCLE, abs=0.021) for gap in gaps)
    assert len(at) == pytest.approx((at[-1] - at[0]) / CYCLE + 1, abs=1)


def test_simple_connect_is_served_from_open_to_close() -> None:
    said = way(SIMPLE, FROM_HOST)
    opened = next(c.time for c in said if encode(b"\x01\x3b\x01\x00") in c.data)
    closed = next(c.time for c in said if encode(b"\x02\x3b\x01\x00") in c.data)
    at = [time for time, r in played_to_firmware(SIMPLE) if isinstance(r, reports.Sip)]
    assert opened <= at[0] <= opened + 0.04
    assert closed - CYCLE - 0.02 <= at[-1] <= closed + 0.02


@each
def test_our_host_opens_and_follows_every_session(capture: Path) -> None:
    host, events, clock = Host(-Timing().listen), [], 0.0
    host.tick(-Timing().listen)
    host.tick(0.0)
    heard = way(capture, FROM_ROBOT)
    for chunk in heard:
        clock = chunk.time - heard[0].time
        events += host.receive(chunk.data, clock)
        events += host.tick(clock)
    assert events[0] == Opened(AMRISIM)
    assert isinstance(events[1], Configured)
    assert events[1].trusted
    assert events[1].config is not None
    assert events[1].config.serial_number == "SIM"
    sent = [reports.from_payload(payload) for payload in payloads(heard)]
    rest = [report for report in sent[3:] if not isinstance(report, reports.Config)]
    assert [e.report for e in events if isinstance(e, ReportReceived)] == rest
    assert (host.reader.bad_checksums, host.reader.bytes_skipped) == (0, 0)


@each
async def test_a_replay_gives_every_snapshot_at_its_time(capture: Path) -> None:
    heard = way(capture, FROM_ROBOT)
    sips = sum(isinstance(reports.from_payload(p), reports.Sip) for p in payloads(heard))
    loop = asyncio.get_running_loop()
    seen = []
    async with connect_async(f"replay:{capture}") as driver:
        assert driver.snapshot is not None
        seen.append(driver.snapshot)
        async for snapshot in driver.snapshots():
            seen.append(snapshot)
            if snapshot.sequence == sips:
                break
        assert driver.info.identity == AMRISIM
    assert {s.link.sessions for s in seen} == {1}
    sequences = [s.sequence for s in seen]
    assert sequences == sorted(set(sequences))
    assert len(seen) >= sips - 2  # of two reports in one read the newer one wins
    took = loop.time() - Timing().listen  # the recording starts with the first question
    assert took == pytest.approx(heard[-1].time - heard[0].time, abs=2 * CYCLE)
    assert all(s.battery.voltage == pytest.approx(13.0) for s in seen)
