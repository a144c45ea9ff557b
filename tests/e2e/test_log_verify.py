"""Today's driver sees in the bytes of a log what was seen then, or says where it does not."""

import asyncio
import json
import time
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

import pytest

from pioneer3.behaviors import engine
from pioneer3.cli.log_verify import verify as verify_command
from pioneer3.errors import ConfigError
from pioneer3.geometry import Twist2
from pioneer3.lasers.client import RawScan
from pioneer3.links import Link
from pioneer3.log.excerpt import write_excerpt
from pioneer3.log.folder import GIB, create
from pioneer3.log.index import LogIndex
from pioneer3.log.mcap import McapFile
from pioneer3.log.reader import open_log, whole_log
from pioneer3.log.target import UserFolder
from pioneer3.log.topics import EVENT, LogEvent, LogTopic
from pioneer3.log.writer import LogWriter
from pioneer3.models import RobotModel, load_model
from pioneer3.models.odometry import OdometryCorrection
from pioneer3.models.own import find_own, own_path
from pioneer3.navigation.connect import connect_async
from pioneer3.robot import explain
from pioneer3.robot.assemble import Assembler
from pioneer3.robot.correction import TwistCorrection
from pioneer3.robot.explain import IDLE_OFF, IDLE_ON, PRESSED, Reason, allowed
from pioneer3.robot.lasers.driver import OPEN_PATIENCE, RETRY
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.ros.node.services import Services
from pioneer3.runtime.recording import RobotLog, recorded
from pioneer3.runtime.verification import verify
from pioneer3.state import Scan, Snapshot
from pioneer3.tasks import FastTimeLoop
from tests.lasers import LaserUnit, OpenedSpec
from tests.logs import snapshot
from tests.support import SimulatedRobot, until

pytestmark = pytest.mark.realtime
NOISE = 40
"""Each so many pieces of bytes from the robot one is damaged."""


@pytest.fixture(scope="module")
def changed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the log of an Amigo, and of a P3-AT that answers at the same port later."""
    path = tmp_path_factory.mktemp("log") / "changed.mcap"

    async def drive() -> None:
        async with SimulatedRobot(model="amigo-sh") as amigo, SimulatedRobot() as p3at:
            there = amigo

            async def opened() -> Link:
                return await there.open()

            async with connect_async(opened, record=path) as robot:
                await robot.move(0.1)
                there = p3at
                await amigo.unplug()
                await until(lambda: robot.snapshot is None)
                await until(lambda: robot.snapshot is not None)
                await robot.move(0.1)

    asyncio.run(drive())
    return path


async def record(path: Path) -> None:
    """Record robots whose cables damage bytes, and the first of which is lost for a while."""

    async def drive(name: str, sim: SimulatedRobot, *, away: bool) -> None:
        async with connect_async(sim.open, record=log and log.of(name)) as robot:
            await robot.move(0.3)
            if away:
                await sim.unplug()
                await until(lambda: robot.snapshot is None)
                sim.plugged = True
                await until(lambda: robot.snapshot is not None)
                await robot.turn(0.5)

    count = 0

    def noisy(data: bytes) -> tuple[bytes, ...]:
        nonlocal count
        count += 1
        return (data[:-1] + bytes([data[-1] ^ 1]) if count % NOISE == NOISE - 1 else data,)

    with recorded(path, asyncio.get_running_loop().time) as log:
        async with SimulatedRobot(to_host=noisy) as first, SimulatedRobot() as second:
            await asyncio.gather(drive("amy", first, away=True), drive("bob", second, away=False))


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the log of two robots."""
    path = tmp_path_factory.mktemp("log") / "two.mcap"
    asyncio.run(record(path))
    return path


def test_all_readings_are_as_recorded_over_losses_and_noise(two: Path) -> None:
    log = open_log(two)
    counts = log.info().counts
    assert counts is not None
    found = verify(log)
    assert [(each.robot, each.difference) for each in found] == [("amy", None), ("bob", None)]
    assert [each.compared for each in found] == [counts["amy/snapshot"], counts["bob/snapshot"]]
    assert [each.decisions for each in found] == [counts["amy/decision"], counts["bob/decision"]]
    assert all(each.velocities > 4 for each in found)
    assert [each.reasons for each in found] == [counts["amy/standing"], counts["bob/standing"]]
    assert found[0].reasons > 3
    *_, last = log.snapshots("amy/snapshot")
    assert last.link.sessions == 2
    assert any(each.link.bad_checksums for each in log.snapshots("amy/snapshot"))


def test_another_robot_at_the_same_port_is_read_by_its_own_model(changed: Path) -> None:
    log = open_log(changed)
    assert [model.name for _, model in log.of(LogTopic("model", RobotModel))] == [
        "amigo-sh",
        "p3at-sh",
    ]
    counts = [len(each.sonar.ranges) for each in log.snapshots()]
    assert (min(counts), max(counts)) == (8, 16)
    (found,) = verify(log)
    assert (found.difference, found.compared) == (None, len(counts))
    (found,) = verify(log, "p3at-sh")
    assert found.difference is not None


def test_the_first_difference_is_told_with_time_field_and_both_values(
    two: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert verify_command(str(two)) == 0
    assert capsys.readouterr().out.count("all as recorded") == 2
    before = Assembler.assemble
    count = 0

    def wrong_at_tenth(self: Assembler, *given: Any, **named: Any) -> Snapshot:
        nonlocal count
        count += 1
        made = before(self, *given, **named)
        battery = replace(made.battery, voltage=11.5)
        return replace(made, battery=battery) if count == 10 else made

    monkeypatch.setattr(Assembler, "assemble", wrong_at_tenth)
    assert verify_command(str(two)) == 1
    text = capsys.readouterr().out
    assert "amy: 9 readings, " in text
    assert " scans as recorded, then a difference at 20" in text
    assert "battery.voltage: recorded 1" in text
    assert "now      11.5" in text
    count = 0
    assert verify_command(str(two), json=True) == 1
    first, second = json.loads(capsys.readouterr().out)
    assert (first["compared"], first["difference"]["field"]) == (9, "battery.voltage")
    assert second["difference"] is None


def test_a_decision_that_is_another_today_is_a_difference(
    two: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine, "_clip", lambda value, top, bottom: value * 1.001)
    first = verify(open_log(two))[0]
    assert first.difference is not None
    assert first.difference.field == "twist.v"
    assert float(first.difference.now) == float(first.difference.recorded) * 1.001


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("limit", lambda twist, *_: Twist2(1.5 * twist.v, twist.w)),
        ("Pilot.asked", lambda pilot, now: pilot._command.twist),  # a command that does not expire
    ],
)
def test_a_velocity_that_no_decision_comes_to_within_its_time_and_limits_is_a_difference(
    name: str, wrong: Any, tmp_path: Path
) -> None:
    async def drive() -> None:
        async with SimulatedRobot() as sim, connect_async(sim.open, record=path) as robot:
            robot.drive(0.3)
            await asyncio.sleep(3.0)

    path = tmp_path / "wrong.mcap"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(f"pioneer3.robot.pilot.{name}", wrong)
        asyncio.run(drive())
    (found,) = verify(open_log(path))
    assert found.decisions > 0
    assert found.difference is not None
    assert found.difference.field == "sent"
    assert found.difference.recorded.startswith("Vel(speed=0.")


def test_a_reason_to_stand_that_the_readings_do_not_allow_is_a_difference(
    two: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def told(**motors: bool) -> tuple[str, str]:
        def wrong(snapshot: Snapshot) -> frozenset[Reason | None]:
            return allowed(replace(snapshot, motors=replace(snapshot.motors, **motors)))

        monkeypatch.setattr("pioneer3.runtime.verification.allowed", wrong)
        difference = verify(open_log(two))[0].difference
        assert difference is not None
        assert difference.field == "standing"
        return difference.recorded, difference.now

    assert told(stop_button=True) == (str(IDLE_OFF), str(PRESSED).removesuffix("."))
    assert told(enabled=True)[0] == str(IDLE_OFF)
    assert str(IDLE_ON).removesuffix(".") in told(enabled=True)[1]
    monkeypatch.setattr(explain, "stands", lambda snapshot: False)
    assert told()[1] == "none"
    monkeypatch.setattr(explain, "stands", lambda snapshot: True)
    assert told()[0] == "none"


def test_velocities_of_a_robot_whose_own_odometry_is_corrected_are_compared_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    odometry = OdometryCorrection(scale=1.03, base_ratio=0.95, wheel_ratio=1.02)
    model = replace(load_model("p3dx-sh"), odometry=odometry)

    async def drive(path: Path) -> None:
        async with (
            SimulatedRobot() as sim,
            connect_async(sim.open, model=model, record=path) as robot,
        ):
            for turn_rate in (0.0, 0.2, -0.35, 5.0):
                for _ in range(10):
                    robot.drive(0.25, turn_rate)
                    await asyncio.sleep(0.1)

    asyncio.run(drive(tmp_path / "a.mcap"))
    (found,) = verify(open_log(tmp_path / "a.mcap"))
    assert found.difference is None
    assert found.velocities > 20
    told = TwistCorrection.told

    def wrong(self: TwistCorrection, twist: Twist2, now: float) -> Twist2:
        made = told(self, twist, now)
        return Twist2(made.v * 1.1, made.w)

    with monkeypatch.context() as patch:
        patch.setattr(TwistCorrection, "told", wrong)
        asyncio.run(drive(tmp_path / "b.mcap"))
    (found,) = verify(open_log(tmp_path / "b.mcap"))
    assert found.difference is not None
    assert found.difference.field == "sent"


def test_a_log_that_is_being_written_is_as_recorded_so_far(tmp_path: Path) -> None:
    async def drive() -> None:
        async with SimulatedRobot() as sim, connect_async(sim.open, record=path) as robot:
            for number in range(25):
                robot.drive(0.1 * (number % 3))
                await asyncio.sleep(0.2)
                if number > 7:
                    (found,) = await asyncio.to_thread(verify, open_log(path))
                    assert found.difference is None
                    assert found.compared > 5

    path = tmp_path / "on.mcap"
    asyncio.run(drive())


def test_all_files_of_a_log_are_verified_whichever_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    async def drive() -> list[Path]:
        clock = asyncio.get_running_loop().time
        folder = UserFolder(tmp_path, "drive", GIB, time.time)
        folder.most = 1000
        log = LogWriter(folder, clock)
        async with SimulatedRobot() as sim, connect_async(sim.open, record=RobotLog(log)) as robot:
            await robot.move(0.3)
        log.close("done")
        return log.files

    first, *rest = asyncio.run(drive())
    for path in (first, rest[-1]):
        assert {"standing", "limits", "model"} <= open_log(path).topics()
        assert verify_command(str(path)) == 0
    every, same = capsys.readouterr().out.splitlines()
    assert every == same
    counts = whole_log(first).info().counts
    assert counts is not None
    assert every.startswith(f"{counts['snapshot']} readings, {counts['decision']} decisions")


def test_a_log_whose_file_in_the_middle_has_gone_is_refused(tmp_path: Path) -> None:
    async def drive() -> list[Path]:
        clock = asyncio.get_running_loop().time
        folder = UserFolder(tmp_path, "drive", GIB, time.time)
        folder.most = 1000
        log = LogWriter(folder, clock)
        async with SimulatedRobot() as sim, connect_async(sim.open, record=RobotLog(log)) as robot:
            while len(log.files) < 3:
                await robot.turn(1.0)
        log.close("done")
        return log.files

    with asyncio.Runner(loop_factory=lambda: FastTimeLoop(0.0)) as runner:
        first, second, *_ = runner.run(drive())
    second.unlink()
    with pytest.raises(ConfigError, match="a file of this log has gone"):
        verify(whole_log(first))


def test_a_log_that_lost_messages_to_a_slow_disk_is_refused(tmp_path: Path) -> None:
    async def drive() -> None:
        with recorded(tmp_path / "a.mcap", asyncio.get_running_loop().time) as log:
            assert log is not None
            async with SimulatedRobot() as sim, connect_async(sim.open, record=log) as robot:
                await robot.turn(1.0)
            log.log.dropped = 7

    asyncio.run(drive())
    with pytest.raises(ConfigError, match="it lacks 7 messages: a slow disk"):
        verify(open_log(tmp_path / "a.mcap"))


def test_a_laser_that_was_opened_some_time_after_the_log_began_has_its_scans(
    tmp_path: Path,
) -> None:
    async def drive() -> None:
        async with SimulatedRobot() as sim, LaserUnit(sim, "utm-30lx") as unit:
            with recorded(path, asyncio.get_running_loop().time) as log:
                await asyncio.sleep(OPEN_PATIENCE + 0.1 * RETRY)
                async with connect_async(sim.open, lasers=[unit.spec()], record=log) as robot:
                    await robot.laser.reading()

    path = tmp_path / "late.mcap"
    asyncio.run(drive())
    (found,) = verify(open_log(path))
    assert found.difference is None
    assert found.scans > 0


@pytest.mark.parametrize("name", ["urg-04lx", "lms-200"])
def test_the_bytes_of_a_laser_become_the_scans_that_were_recorded(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def drive() -> None:
        async with (
            SimulatedRobot() as sim,
            LaserUnit(sim, name) as unit,
            connect_async(sim.open, lasers=[unit.spec()], record=path) as robot,
        ):
            await robot.laser.reading()
            await robot.move(0.2)

    path = tmp_path / "scans.mcap"
    asyncio.run(drive())
    counts = open_log(path).info().counts
    assert counts is not None
    (found,) = verify(open_log(path))
    assert found.difference is None
    assert found.scans == counts["scan/laser"] > 5
    before = Mounting.scan

    def longer(mounting: Mounting, raw: RawScan, *others: Any) -> Scan:
        return before(mounting, replace(raw, ranges=(*raw.ranges[:-1], 1.0)), *others)

    monkeypatch.setattr(Mounting, "scan", longer)
    (found,) = verify(open_log(path))
    assert found.difference is not None
    assert found.difference.field.startswith("ranges[")
    assert float(found.difference.now) == 1.0


def test_a_laser_that_is_started_again_before_its_late_bytes_are_read_is_so_again(
    tmp_path: Path,
) -> None:
    async def drive() -> None:
        is_late = False

        async def opened() -> Link:
            link = await unit.open()
            read, kept = link.read, list[bytes]()

            async def read_late() -> bytes:
                nonlocal is_late
                data = kept.pop() if kept else await read()
                if is_late:
                    is_late = False
                    kept.append(data)
                    await asyncio.sleep(inf)  # the driver gives up before
                return data

            link.read = read_late  # type: ignore[method-assign]
            return link

        async with SimulatedRobot() as sim, LaserUnit(sim, "utm-30lx") as unit:
            spec = OpenedSpec(url=unit.url, open=opened)
            async with connect_async(sim.open, lasers=[spec], record=path) as robot:
                await robot.laser.reading()
                is_late = True
                await until(lambda: not is_late)
                await robot.laser.reading()

    path = tmp_path / "late.mcap"
    asyncio.run(drive())
    written = [each.data for each in open_log(path).messages("wire/laser/out".__eq__)]
    assert written.count(b"\nQT\n") == 2
    (found,) = verify(open_log(path))
    assert found.difference is None
    assert found.scans > 1


def test_odometry_that_a_service_restarts_restarts_again(tmp_path: Path) -> None:
    async def drive() -> None:
        async with SimulatedRobot() as sim, connect_async(sim.open, record=path) as robot:
            services = Services(
                robot, sonar=True, diagnose=list, moved=lambda: None, warn=lambda text: None
            )
            await robot.move(0.3)
            assert services.reset_odometry().success
            await robot.move(0.1)

    path = tmp_path / "restarted.mcap"
    asyncio.run(drive())
    last = [*open_log(path).snapshots()][-1]
    assert 0.0 < last.odometry.robot_in_odom.x < 0.2
    (found,) = verify(open_log(path))
    assert found.difference is None


def test_the_model_of_that_time_counts_whatever_file_the_robot_has_today(
    two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    name = open_log(two).info().texts["amy/robot"]["name"]
    own = own_path(name)
    assert own is not None
    own.parent.mkdir(parents=True)
    own.write_text("distance_factor = 0.002\n")
    today = find_own([name], load_model("p3at-sh"))
    assert today is not None
    difference = verify(open_log(two), today.model)[0].difference
    assert difference is not None
    assert difference.field.startswith("odometry")
    assert verify(open_log(two))[0].difference is None


def test_readings_that_do_not_come_any_more_are_a_difference(
    two: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pioneer3.robot.session.Session._handle_report", lambda *_: None)
    difference = verify(open_log(two))[0].difference
    assert difference is not None
    assert (difference.field, difference.recorded, difference.now) == ("sequence", "1", "none")


def test_a_log_whose_clock_is_no_number_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    file = McapFile(create(path))
    file.add_metadata("program", {"clock": "inf", "began_ns": "7"})
    file.add(LogTopic("wire/robot/in", bytes), [(7, b"a")])
    file.add(LogTopic("snapshot", LogEvent), [(7, LogEvent("a", "b"))])
    file.finish()
    with pytest.raises(ConfigError, match="it lacks the exact times of bytes"):
        verify(open_log(path))


def test_a_log_whose_laser_is_opened_in_a_hundred_years_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    file = McapFile(create(path))
    file.add_metadata("program", {"clock": "5.0", "began_ns": str(10**18)})
    told = {
        "protocol": '"SCIP"',
        "speeds": "[]",
        "mounting": "{}",
        "settings": "{}",
        "time_offset": "0",
    }
    file.add_metadata("laser", told)
    file.add(EVENT, [(10**18, LogEvent("link", "robot: open: tcp://a"))])
    file.add(EVENT, [(10**18, LogEvent("link", "laser: open: tcp://b"))])
    file.add(LogTopic("wire/robot/in", bytes), [(10**18, b"a")])
    file.add(LogTopic("snapshot", Snapshot), [(10**18, snapshot(0.0))])
    file.flush()
    file.add(EVENT, [(4 * 10**18, LogEvent("link", "laser: closed"))])
    file.add(EVENT, [(4 * 10**18, LogEvent("link", "laser: open: tcp://b"))])
    file.finish()
    with pytest.raises(ConfigError, match="its bytes are weeks apart"):
        verify(open_log(path))


def test_a_part_of_a_log_is_refused(two: Path, tmp_path: Path) -> None:
    log, part = LogIndex(two), tmp_path / "part.mcap"
    known = log.info()
    write_excerpt(log, part, known.began + 2 * 10**9, known.ended)
    with pytest.raises(ConfigError, match="its connection began before"):
        verify(open_log(part))
