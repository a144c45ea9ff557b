"""What the robot view is told: to whom, how often, and what. Virtual time."""

import asyncio

import pytest

from pioneer3.arcos.reports import Config, Io, Report
from pioneer3.sim.equipment import Equipment
from pioneer3.web import messages
from pioneer3.web.access.sessions import Role
from pioneer3.web.details import PERIOD, RobotDetails
from tests.unit.web.browser import Browser, Product, playground, product
from tests.unit.web.test_roles import arrive


def heard_of(the: Product, kind: type[Report]) -> list[Report]:
    """Return a list that grows with every report of a kind from now on."""
    heard: list[Report] = []
    the.robot.supervisor.reports.hand_to(lambda report, stamp: heard.append(report), kind)
    return heard


async def test_details_go_to_who_has_them_open_and_end_when_they_are_closed() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("watch_details", on=True)
        await asyncio.sleep(10 * PERIOD)
        count = len(ann.all("details"))
        assert 9 <= count <= 11
        assert bob.all("details") == []
        ann.say("watch_details", on=False)
        await asyncio.sleep(4 * PERIOD)
        assert len(ann.all("details")) <= count + 1


async def test_details_are_encoded_once_for_all(monkeypatch: pytest.MonkeyPatch) -> None:
    made = 0
    describe = RobotDetails._describe

    def counted(self: RobotDetails, now: float) -> messages.Message:
        nonlocal made
        made += 1
        return describe(self, now)

    monkeypatch.setattr(RobotDetails, "_describe", counted)
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("watch_details", on=True)
        bob.say("watch_details", on=True)
        await asyncio.sleep(10 * PERIOD)
        assert len(ann.all("details")) + len(bob.all("details")) >= 18
        assert made <= 11


async def test_details_tell_what_no_snapshot_does() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("watch_details", on=True)
        await ann.keep_driving(0.3, 4.0)
        details = ann.latest("details")
        assert details["known"]
        assert set(details).isdisjoint(set(ann.snapshot) - {"robot", "faults"})
        assert details["robot_in_encoder"]["x"] > 0.5
        assert details["wheels"]["left"] == pytest.approx(0.3, abs=0.05)
        assert details["stalls"] == {"left": False, "right": False}
        assert len(details["lines"]["analog"]) == 8
        assert len(details["lines"]["digital_in"]) > 8  # more than a standard report has
        assert "motors enabled" in details["flags"]
        words = {sensor["name"]: sensor["words"] for sensor in details["sensors"]}
        assert "no gyro" in words["gyro"]
        checks = {finding["check"]: finding for finding in details["findings"]}
        assert checks["reports"]["level"] == "ok"
        assert "10 " in checks["reports"]["found"]


async def test_a_sensor_that_is_there_is_read_while_somebody_looks() -> None:
    fitted = Equipment(gyro_type=1)
    async with product(equipment=fitted) as the, Browser(the.app) as ann:
        ann.say("watch_details", on=True)
        await asyncio.sleep(4.0)
        gyro = {sensor["name"]: sensor for sensor in ann.latest("details")["sensors"]}["gyro"]
        assert [value["label"] for value in gyro["values"]] == ["heading", "rate"]
        assert gyro["values"][1]["text"].endswith("°/s")


async def test_lines_are_asked_for_only_while_somebody_looks() -> None:
    async with product() as the, Browser(the.app) as ann:
        heard = heard_of(the, Io)
        await asyncio.sleep(3.0)
        assert heard == []
        ann.say("watch_details", on=True)
        await asyncio.sleep(5.0)
        assert 4 <= len(heard) <= 6
        await ann.leave()
        await asyncio.sleep(2.0)
        assert len(heard) <= 6


async def test_a_viewer_may_look_at_details_and_config() -> None:
    async with product() as the, arrive(the, Role.VIEWER) as vera:
        vera.say("watch_details", on=True)
        vera.say("ask_config")
        await asyncio.sleep(2.0)
        assert vera.all("refused") == []
        assert vera.latest("details")["known"]
        assert vera.latest("config")["error"] is None


async def test_config_comes_from_the_robot_when_it_is_asked_for() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        heard = heard_of(the, Config)
        await asyncio.sleep(1.0)
        assert heard == []
        for page in (ann, bob):
            page.say("watch_details", on=True)
            page.say("ask_config")
            page.say("ask_config")
        await asyncio.sleep(2.0)
        rows = {row["field"]: row for row in ann.latest("config")["rows"]}
        assert rows["sip_cycle"] == {
            "group": "Communication",
            "field": "sip_cycle",
            "value": "100",
            "unit": "ms",
            "meaning": "between two information packets",
        }
        assert bob.latest("config")["rows"] == ann.latest("config")["rows"]
        assert len(heard) == 1  # who asks right after another gets the same answer


async def test_stops_are_heard_while_the_robot_is_asked_for_config() -> None:
    async with product() as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 1.5)
        ann.say("ask_config")
        ann.say("emergency_stop")
        await asyncio.sleep(0.02)
        assert the.robot.supervisor.pilot.emergency


async def test_a_paused_simulation_is_not_called_a_bad_line() -> None:
    async with playground() as the, Browser(the.app) as ann:
        ann.say("watch_details", on=True)
        ann.say("speed", speed=0.25)
        await asyncio.sleep(15.0)
        (finding,) = ann.latest("details")["findings"]
        assert finding["level"] == "ok"
        assert "0.25 times" in finding["found"]


async def test_a_lost_robot_is_said_to_be_unknown_and_comes_back() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("watch_details", on=True)
        await asyncio.sleep(1.0)
        await the.sim.unplug()
        await asyncio.sleep(4.0)
        assert ann.latest("details") == {"type": "details", "robot": 1, "known": False}
        ann.say("ask_config")
        await asyncio.sleep(0.5)
        assert "no robot is connected" in ann.latest("config")["error"]
        the.sim.plugged = True
        await asyncio.sleep(8.0)
        assert ann.latest("details")["known"]
        ann.say("ask_config")
        await asyncio.sleep(2.0)
        assert ann.latest("config")["error"] is None
