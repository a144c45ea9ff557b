"""Who may change the simulated world, and how. Virtual time, but for robots that come and go."""

import asyncio
from typing import Any

import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.sim.server.start import simulator
from pioneer3.web import requests
from pioneer3.web.control import TERM
from pioneer3.web.editor import MOST_OBSTACLES, Editor
from pioneer3.web.messages import Added
from pioneer3.web.world import WorldView
from tests.support import wall_at
from tests.unit.web.browser import Browser, playground, product

ANN, BOB = "ann", "bob"
SOON = 0.25
OWN = 1
AWAY = Pose2(0.0, 6.0)


async def answer_to(who: Browser, type_: str, **fields: object) -> dict[str, Any]:
    """Ask, and return the answer."""
    before = len(who.heard)
    who.say(type_, **fields)
    await asyncio.sleep(0.01)
    kinds = {"added", "edit_refused", "refused"}
    (answer,) = [message for message in who.heard[before:] if message["type"] in kinds]
    return answer


def refusal(message: str) -> dict[str, str]:
    return {"type": "edit_refused", "message": message}


async def test_a_box_is_added_where_it_is_asked_for() -> None:
    async with playground() as the, Browser(the.app) as ann:
        answer = await answer_to(ann, "add_box", x=3, y=1, theta=7, length=1, width=0.5)
        assert answer == {"type": "added", "id": 2}
        (box,) = the.simulation.world.obstacles
        assert (box.pose.x, box.pose.y) == (3.0, 1.0)
        assert box.pose.theta == pytest.approx(7 - 2 * 3.14159265)
        assert box.sizes == (0.5, 0.5, 0.25, 0.0)
        await asyncio.sleep(SOON)
        (thing,) = ann.latest("world")["things"] or ann.all("world")[1]["things"]
        assert (thing["id"], thing["kind"]) == (2, "box")


async def test_a_box_before_the_robot_is_what_its_sonar_hears() -> None:
    async with playground() as the, Browser(the.app) as ann:
        await asyncio.sleep(SOON)
        assert set(ann.snapshot["sonar"]["ranges"]) == {None}
        ann.say("add_box", x=1.5, y=0, theta=0, length=0.5, width=3)
        await asyncio.sleep(1.0)
        ahead = min(filter(None, ann.snapshot["sonar"]["ranges"]))
        assert 0.8 < ahead < 1.3


async def test_people_stand_or_walk_to_and_fro() -> None:
    async with playground() as the, Browser(the.app) as ann:
        ann.say("add_person", path=[[3, 0]])
        ann.say("add_person", path=[[3, 2], [4, 2]])
        await asyncio.sleep(2.0)
        stands, walks = the.simulation.world.obstacles
        assert not stands.walks
        assert (stands.pose.x, stands.pose.y) == (3.0, 0.0)
        assert walks.walks
        assert 3.0 < walks.pose.x < 4.0
        assert ann.latest("world")["moved"][0][0] == 3


@pytest.mark.parametrize(
    ("type_", "fields"),
    [
        ("add_box", {"x": 0.1, "y": 0, "theta": 0, "length": 0.2, "width": 0.2}),
        ("add_box", {"x": 0, "y": 0, "theta": 0, "length": 9, "width": 9}),
        ("add_person", {"path": [[0.3, 0], [5, 0]]}),
    ],
)
async def test_nothing_is_put_on_a_robot(type_: str, fields: dict[str, Any]) -> None:
    async with playground() as the, Browser(the.app) as ann:
        answer = await answer_to(ann, type_, **fields)
        assert answer["type"] == "edit_refused"
        assert answer["message"].startswith("robot-1 stands at ")
        assert the.simulation.world.obstacles == ()


async def test_nothing_is_dragged_onto_a_robot() -> None:
    async with playground() as the, Browser(the.app) as ann:
        await answer_to(ann, "add_box", x=3, y=0, theta=0, length=0.5, width=0.5)
        answer = await answer_to(ann, "move", id=2, x=0.3, y=0, theta=0)
        assert answer == refusal("robot-1 stands at 0.30 0.00; choose another place")
        assert the.simulation.world.obstacles[0].pose == Pose2(3.0, 0.0, 0.0)


async def test_robots_are_dragged_to_free_places_only() -> None:
    async with playground(Pose2(), AWAY, line_map=wall_at(5.0)) as the, Browser(the.app) as ann:
        ann.say("move", id=OWN, x=2, y=1, theta=1)
        await asyncio.sleep(SOON)
        assert the.simulation.robots[0].body.robot_in_world == Pose2(2.0, 1.0, 1.0)
        for x, y in ((5.0, 0.0), (0.0, 6.0)):
            answer = await answer_to(ann, "move", id=OWN, x=x, y=y, theta=0)
            assert answer["message"].startswith("robot-1: something stands at ")
        assert ann.snapshot["robot_in_map"] == {"x": 2.0, "y": 1.0, "theta": 1.0}


async def test_who_lifts_the_robot_stops_it() -> None:
    async with playground() as the, Browser(the.app) as ann:
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 3.0))
        await asyncio.sleep(1.5)
        body = the.simulation.robots[0].body
        assert body.speeds[0] == pytest.approx(0.3, abs=0.01)
        ann.say("move", id=OWN, x=0, y=3, theta=0)
        await asyncio.sleep(0.4)
        ann.say("move", id=OWN, x=0, y=4, theta=0)
        await asyncio.sleep(0.4)
        assert body.speeds[0] == 0.0
        assert the.simulation.robots[0].body.robot_in_world.y == 4.0
        assert ann.latest("refused")["message"].startswith("somebody stopped the robot")
        await driving
        ann.drive(0.0)
        await ann.keep_driving(0.3, 1.5)
        assert body.speeds[0] == pytest.approx(0.3, abs=0.01)


async def test_nobody_lifts_a_robot_that_somebody_else_drives() -> None:
    async with playground() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 2.0))
        await asyncio.sleep(1.0)
        before = the.simulation.robots[0].body.robot_in_world
        answer = await answer_to(bob, "move", id=OWN, x=0, y=3, theta=0)
        assert answer == refusal("somebody else drives")
        await driving
        assert the.simulation.robots[0].body.robot_in_world.x > before.x
        assert ann.driver == "you"


async def test_nobody_drives_a_robot_that_somebody_else_drags() -> None:
    async with playground() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("move", id=OWN, x=0, y=3, theta=0)
        await asyncio.sleep(0.1)
        bob.drive(0.3)
        await asyncio.sleep(TERM)
        assert bob.all("refused")[0]["message"] == "script has control"
        await bob.keep_driving(0.3, 1.5)
        assert the.simulation.robots[0].body.speeds[0] == pytest.approx(0.3, abs=0.01)


async def test_boxes_may_be_put_in_the_way_of_somebody_who_drives() -> None:
    async with playground() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 5.0))
        await asyncio.sleep(1.0)
        bob.say("add_box", x=1.2, y=0, theta=0, length=0.5, width=2)
        await driving
        body = the.simulation.robots[0].body
        assert body.stalled or body.speeds[0] == 0.0
        assert body.robot_in_world.x < 0.95
        assert bob.all("edit_refused") == []


async def test_one_at_a_time_drags_a_box() -> None:
    async with playground() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("add_box", x=3, y=0, theta=0, length=0.5, width=0.5)
        ann.say("move", id=2, x=3, y=1, theta=0)
        await asyncio.sleep(0.1)
        answer = await answer_to(bob, "move", id=2, x=3, y=2, theta=0)
        assert answer == refusal("somebody else holds it")
        await asyncio.sleep(TERM)
        bob.say("move", id=2, x=3, y=2, theta=0)
        await asyncio.sleep(0.1)
        assert the.simulation.world.obstacles[0].pose.y == 2.0


async def test_things_are_removed_and_gone_for_everybody() -> None:
    async with playground() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("add_box", x=3, y=0, theta=0, length=0.5, width=0.5)
        ann.say("remove", id=2)
        await asyncio.sleep(SOON)
        assert the.simulation.world.obstacles == ()
        answer = await answer_to(bob, "remove", id=2)
        assert answer == refusal("this is not there any more")


async def test_the_robot_of_the_page_stays() -> None:
    async with playground() as the, Browser(the.app) as ann:
        answer = await answer_to(ann, "remove", id=OWN)
        assert answer == refusal("robot-1: this page drives it; it stays")
        assert len(the.simulation.robots) == 1


async def test_anybody_presses_a_stop_button_and_who_may_drive_releases_it() -> None:
    async with playground() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        driving = asyncio.ensure_future(ann.keep_driving(0.3, 2.0))
        await asyncio.sleep(1.0)
        bob.say("stop_button", id=OWN, pressed=True)
        await asyncio.sleep(0.5)
        body = the.simulation.robots[0].body
        assert not body.drive.powered
        assert ann.snapshot["motors"]["stop_button"]
        answer = await answer_to(bob, "stop_button", id=OWN, pressed=False)
        assert answer == refusal("somebody else drives")
        await driving
        await asyncio.sleep(TERM)
        bob.say("stop_button", id=OWN, pressed=False)
        await asyncio.sleep(0.1)
        assert not body.stop_button


async def test_a_cable_is_pulled_and_put_in_again() -> None:
    async with playground() as the, Browser(the.app) as ann:
        ann.say("cable", id=OWN, plugged=False)
        await asyncio.sleep(1.0)
        assert ann.latest("status")["state"] in {"lost", "connecting"}
        ann.say("cable", id=OWN, plugged=True)
        await asyncio.sleep(8.0)
        assert ann.latest("status")["state"] == "connected"


async def test_a_box_has_neither_button_nor_cable() -> None:
    async with playground() as the, Browser(the.app) as ann:
        await answer_to(ann, "add_box", x=3, y=0, theta=0, length=0.5, width=0.5)
        for type_, fields in (("stop_button", {"pressed": True}), ("cable", {"plugged": False})):
            answer = await answer_to(ann, type_, id=2, **fields)
            assert answer == refusal("only robots have a stop button, a cable and a battery")


async def test_time_is_paused_stepped_and_sped_up() -> None:
    async with playground() as the, Browser(the.app) as ann:
        ann.say("pause", paused=True)
        await asyncio.sleep(0.1)
        began = the.simulation.world.time
        await asyncio.sleep(1.0)
        assert the.simulation.world.time == began
        ann.say("step", seconds=0.1)
        await asyncio.sleep(0.5)
        assert the.simulation.world.time == pytest.approx(began + 0.1)
        assert ann.latest("world")["clock"]["time"] == pytest.approx(began + 0.1, abs=0.005)
        ann.say("speed", speed=5)
        ann.say("pause", paused=False)
        await asyncio.sleep(1.0)
        assert the.simulation.world.time == pytest.approx(began + 5.1, abs=0.2)


@pytest.mark.parametrize(
    ("type_", "fields"),
    [("pause", {"paused": True}), ("speed", {"speed": 10}), ("step", {"seconds": 1})],
)
async def test_time_belongs_to_who_drives(type_: str, fields: dict[str, Any]) -> None:
    async with playground() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        await ann.keep_driving(0.3, 0.5)
        answer = await answer_to(bob, type_, **fields)
        assert answer == refusal("somebody else drives")
        assert (the.simulation.pace.paused, the.simulation.pace.speed) == (False, 1.0)


async def test_a_page_does_not_fill_the_world() -> None:
    async with playground() as the, Browser(the.app) as ann:
        for number in range(MOST_OBSTACLES + 5):
            ann.say("add_person", path=[[9, number]])
        await asyncio.sleep(SOON)
        assert len(the.simulation.world.obstacles) == MOST_OBSTACLES
        assert ann.latest("edit_refused")["message"] == (
            "there are 200 boxes and people already; remove some first"
        )


async def test_a_battery_is_drained_and_filled() -> None:
    async with playground() as the, Browser(the.app) as ann:
        battery = the.simulation.robots[0].body.battery
        ann.say("charge", id=OWN, charge=0.05)
        await asyncio.sleep(SOON)
        assert battery.charge == pytest.approx(0.05, abs=0.01)
        assert ann.snapshot["battery"]["low"]
        assert ann.latest("world")["things"][0]["charge"] == 0.05
        ann.say("charge", id=OWN, charge=1)
        await asyncio.sleep(SOON)
        assert not ann.snapshot["battery"]["low"]
        await answer_to(ann, "add_person", path=[[5, 5]])
        answer = await answer_to(ann, "charge", id=2, charge=0.5)
        assert answer["type"] == "edit_refused"


async def test_another_map_is_shown_when_a_client_loads_one() -> None:
    async with playground() as the, Browser(the.app) as ann:
        await asyncio.sleep(SOON)
        assert ann.latest("map")["map"]["walls"] == []
        lab: LineMap = wall_at(5.0)
        the.simulation.world.change_map(lab)
        await asyncio.sleep(SOON)
        assert ann.latest("map")["map"]["walls"] == [[5.0, -5.0, 5.0, 5.0]]


async def test_the_world_of_a_real_robot_is_not_to_be_changed() -> None:
    async with product() as the, Browser(the.app) as ann:
        assert ann.latest("hello")["models"] is None
        answer = await answer_to(ann, "add_box", x=3, y=0, theta=0, length=0.5, width=0.5)
        assert answer == refusal("only a simulated world can be changed here")
        await asyncio.sleep(SOON)
        assert ann.all("world") == []


@pytest.mark.parametrize(
    ("type_", "fields"),
    [
        ("add_box", {"x": 1e9, "y": 0, "theta": 0, "length": 1, "width": 1}),
        ("add_box", {"x": 3, "y": 0, "theta": 0, "length": 0, "width": 1}),
        ("add_box", {"x": 3, "y": 0, "theta": 0, "length": 1e6, "width": 1}),
        ("add_box", {"x": 3, "y": float("nan"), "theta": 0, "length": 1, "width": 1}),
        ("add_box", {"x": 3, "y": 0, "theta": float("inf"), "length": 1, "width": 1}),
        ("add_box", {"x": 3, "y": 0, "theta": 0, "length": 1, "width": 1, "name": "x"}),
        ("add_person", {"path": []}),
        ("add_person", {"path": [[0, 0, 0]]}),
        ("add_person", {"path": [[0, 9]] * 21}),
        ("add_robot", {"model": 7, "x": 3, "y": 0, "theta": 0}),
        ("move", {"id": "2", "x": 0, "y": 0, "theta": 0}),
        ("move", {"id": 1, "x": 0, "y": 0}),
        ("remove", {"id": None}),
        ("stop_button", {"id": 1, "pressed": 1}),
        ("speed", {"speed": 0}),
        ("speed", {"speed": 1e9}),
        ("step", {"seconds": -1}),
        ("step", {"seconds": 1e9}),
        ("pause", {}),
    ],
)
async def test_nonsense_is_refused_and_changes_nothing(type_: str, fields: dict[str, Any]) -> None:
    async with playground() as the, Browser(the.app) as ann:
        answer = await answer_to(ann, type_, **fields)
        assert answer["type"] == "refused"
        assert answer["message"].startswith("not understood: ")
        assert the.simulation.world.obstacles == ()
        assert the.simulation.robots[0].body.robot_in_world == Pose2()
        assert not the.simulation.pace.paused
        await ann.keep_driving(0.3, 1.5)
        assert the.simulation.robots[0].body.speeds[0] == pytest.approx(0.3, abs=0.01)


@pytest.mark.parametrize(
    "model", ["r2d2", "", "/etc/passwd", "../secret.toml", "robot.p", "x" * 999]
)
async def test_only_shipped_models_are_added(model: str) -> None:
    async with playground() as the, Browser(the.app) as ann:
        answer = await answer_to(ann, "add_robot", model=model, x=3, y=0, theta=0)
        assert answer["message"].startswith(f"{model[:40]}: no such model; ")
        assert len(the.simulation.robots) == 1


async def test_no_robot_begins_in_a_wall_a_box_or_another() -> None:
    async with playground(Pose2(), line_map=wall_at(5.0)) as the, Browser(the.app) as ann:
        await answer_to(ann, "add_box", x=0, y=5, theta=0, length=3, width=3)
        for x, y in ((5, 0), (0, 5), (0.2, 0)):
            answer = await answer_to(ann, "add_robot", model="p3dx-sh", x=x, y=y, theta=0)
            assert answer["message"].startswith("p3dx-sh: something stands at ")
        assert len(the.simulation.robots) == 1


@pytest.mark.realtime
async def test_a_robot_comes_can_be_connected_to_and_goes() -> None:
    async with simulator(map_name="empty", port=0) as here:
        view = WorldView(here)
        editor = Editor(view, take_control=lambda *_: True, stop=lambda _: None)
        answer = await editor.apply(ANN, requests.AddRobot("p3dx-sh", 3.0, 0.0, 1.0))
        assert answer == Added(2)
        added = here.robots[1]
        assert added.body.robot_in_world == Pose2(3.0, 0.0, 1.0)
        host, port = added.url.removeprefix("tcp://").split(":")
        _, writer = await asyncio.open_connection(host, port)
        writer.close()
        assert await editor.apply(BOB, requests.Remove(2)) is None
        assert len(here.robots) == len(here.world.robots) == 1
        with pytest.raises(ConnectionRefusedError):
            await asyncio.open_connection(host, port)


@pytest.mark.realtime
async def test_a_page_that_goes_leaves_a_whole_robot_or_none() -> None:
    async with simulator(map_name="empty", port=0) as here:
        editor = Editor(WorldView(here), lambda *_: True, lambda _: None)
        adding = asyncio.ensure_future(
            editor.apply(ANN, requests.AddRobot("p3dx-sh", 3.0, 0.0, 0.0))
        )
        await asyncio.sleep(0)
        adding.cancel()
        await asyncio.gather(adding, return_exceptions=True)
        async with asyncio.timeout(10):
            while len(here.robots) < 2:  # noqa: ASYNC110  nobody tells when
                await asyncio.sleep(0.01)
        assert len(here.robots) == len(here.world.robots) == 2
