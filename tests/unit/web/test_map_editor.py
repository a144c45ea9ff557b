"""The map is edited on the page: a draft, which is saved and then driven on. Virtual time."""

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from pioneer3 import connect_async
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject, read_map
from pioneer3.sim.relief import Cylinder, Ramp, Table
from pioneer3.sim.worldfile import Box, Wall, WorldFile, load_map, load_world
from pioneer3.tasks import running
from pioneer3.web import requests
from pioneer3.web.app import make_app
from pioneer3.web.page import Page
from pioneer3.web.scene import RemoteWorld, RobotScene
from tests.support import SimulatedRobot
from tests.unit.web.browser import Browser, Playground, playground
from tests.unit.web.test_navigation import arrived, at_once

SIDES = [[-4, -3, 4, -3], [4, -3, 4, 3], [4, 3, -4, 3], [-4, 3, -4, -3], [1, 1, 1, 2]]
LAB = MapObject(kind="Goal", name="Lab", pose=Pose2(2.0, 2.0))
ROOM = LineMap(name="room", walls=np.array(SIDES, dtype=np.float64), objects=(LAB,))


@asynccontextmanager
async def room(folder: Path) -> AsyncIterator[tuple[Playground, Browser]]:
    async with playground(line_map=ROOM) as the, Browser(the.app) as ann:
        the.page.map_editor.in_thread, the.page.map_editor.folder = at_once, folder
        await asyncio.sleep(0.3)
        yield the, ann


async def edit(who: Browser, type_: str, **fields: object) -> dict[str, Any]:
    """Ask for an edit; return the draft after it."""
    who.say(type_, **fields)
    await asyncio.sleep(0.3)
    return who.latest("map_draft")


async def refused(who: Browser, type_: str, **fields: object) -> str:
    before = len(who.all("edit_refused"))
    who.say(type_, **fields)
    await asyncio.sleep(0.3)
    (refusal,) = who.all("edit_refused")[before:]
    return str(refusal["message"])


def names(draft: dict[str, Any]) -> list[str]:
    return [item["name"] for item in draft["map"]["objects"]]


async def test_edits_change_a_draft_and_not_what_robots_use(tmp_path: Path) -> None:
    async with room(tmp_path) as (the, ann):
        await edit(ann, "erase_walls", x0=1.5, y0=2.5, x1=0.5, y1=0.5)
        await edit(ann, "draw_wall", x0=0, y0=-1, x1=2, y1=-1)
        await edit(ann, "forbid", shape="area", x0=-3, y0=-2, x1=-2, y1=-1, name="stairs")
        await edit(ann, "forbid", shape="line", x0=-3, y0=2, x1=-2, y1=2, name="")
        draft = await edit(ann, "name_place", role="dock", name="Charger", x=3, y=0, heading=1.5)
        assert draft["map"]["walls"] == [*map(list, SIDES[:4]), [0, -1, 2, -1]]
        assert names(draft) == ["Lab", "stairs", "", "Charger"]
        assert draft["map"]["objects"][3]["role"] == "dock"
        assert draft["steps"] == 5
        assert the.simulation.world.map is ROOM
        assert len(ann.latest("map")["map"]["walls"]) == 5


async def test_undoing_goes_back_step_by_step(tmp_path: Path) -> None:
    async with room(tmp_path) as (_, ann):
        await edit(ann, "name_place", role="goal", name="A", x=3, y=0)
        await edit(ann, "name_place", role="goal", name="B", x=3, y=1)
        assert names(await edit(ann, "undo_map_edit")) == ["Lab", "A"]
        assert (await edit(ann, "undo_map_edit"))["map"] is None
        assert await refused(ann, "undo_map_edit") == "there is no edit to undo"
        await edit(ann, "name_place", role="goal", name="A", x=3, y=0)
        assert (await edit(ann, "discard_map_edits"))["map"] is None


async def test_objects_are_named_by_number_and_version(tmp_path: Path) -> None:
    async with room(tmp_path) as (_, ann):
        first = await edit(ann, "name_place", role="goal", name="A", x=3, y=0)
        second = await edit(
            ann, "rename_object", number=0, version=first["version"], name="Ärztin 2"
        )
        assert names(second) == ["Ärztin 2", "A"]
        why = await refused(ann, "remove_object", number=0, version=first["version"])
        assert "changed meanwhile" in why
        why = await refused(ann, "remove_object", number=9, version=second["version"])
        assert "changed meanwhile" in why
        last = await edit(ann, "remove_object", number=0, version=second["version"])
        assert names(last) == ["A"]


async def test_a_saved_map_is_used_from_then_on(tmp_path: Path) -> None:
    async with room(tmp_path) as (the, ann):
        await edit(ann, "draw_wall", x0=0.8, y0=-1, x1=0.8, y1=1)
        await edit(ann, "name_place", role="goal", name="Kitchen", x=3, y=0)
        assert (await edit(ann, "save_map", name="lab"))["map"] is None
        assert ann.latest("told")["message"] == "Saved lab.map, in the folder of this program."
        assert [item["name"] for item in ann.latest("map")["map"]["objects"]] == ["Lab", "Kitchen"]
        await asyncio.sleep(1.0)
        heard = min(r for r in ann.snapshot["sonar"]["ranges"] if r is not None)
        assert heard < 0.8  # the simulated world is the map
        assert the.simulation.world.map.objects[1].name == "Kitchen"
        await edit(ann, "name_place", role="goal", name="Hall", x=-3, y=0)
        await edit(ann, "save_map", name="lab", format=".yaml")
        assert "Not in it: 3 places and areas." in ann.latest("told")["message"]
    assert [item.name for item in read_map(tmp_path / "lab.map").objects] == ["Lab", "Kitchen"]
    assert (tmp_path / "lab.yaml").exists()


async def test_no_file_is_written_over(tmp_path: Path) -> None:
    (tmp_path / "lab.map").write_text("precious")
    async with room(tmp_path) as (_, ann):
        await edit(ann, "name_place", role="goal", name="A", x=3, y=0)
        await edit(ann, "save_map", name="lab", format=".toml")
    assert (tmp_path / "lab.map").read_text() == "precious"
    assert [item.name for item in load_map(tmp_path / "lab-2.toml").objects] == ["Lab", "A"]


async def test_a_robot_that_drives_keeps_its_map(tmp_path: Path) -> None:
    async with room(tmp_path) as (the, ann):
        await edit(ann, "name_place", role="goal", name="A", x=3, y=0)
        ann.say("start_mode", mode={"mode": "wander", "seconds": 60})
        await asyncio.sleep(0.5)
        why = await refused(ann, "save_map", name="lab")
        assert why == "a robot drives on the map before: end wander first"
        assert the.simulation.world.map is ROOM
    assert not (tmp_path / "lab.map").exists()


async def test_what_does_not_go_is_refused_and_changes_nothing(tmp_path: Path) -> None:
    async with room(tmp_path) as (_, ann):
        assert "no wall is inside" in await refused(ann, "erase_walls", x0=0, y0=0, x1=0.5, y1=0.5)
        assert "two ends" in await refused(ann, "draw_wall", x0=0, y0=0, x1=0, y1=0)
        assert await refused(ann, "save_map", name="lab") == "nothing was edited"
        for wrong in ({"name": "../lab"}, {"name": "lab", "format": ".exe"}):
            ann.say("save_map", **wrong)
            await asyncio.sleep(0.1)
            assert "not understood" in ann.latest("refused")["message"]
        assert ann.all("map_draft") == []


@pytest.mark.parametrize("name", ["", " A", "A ", 'A"B', "A\nB", "x" * 41])
def test_names_of_places_are_plain(name: str) -> None:
    text = json.dumps({"type": "name_place", "role": "goal", "x": 0, "y": 0, "name": name})
    with pytest.raises(msgspec.ValidationError, match=r"\$.name"):
        requests.decode(text)


async def test_a_draft_of_a_map_that_nobody_uses_any_more_is_dropped(tmp_path: Path) -> None:
    async with room(tmp_path) as (the, ann):
        await edit(ann, "name_place", role="goal", name="A", x=3, y=0)
        the.simulation.world.change_map(LineMap(name="other", walls=ROOM.walls))
        await asyncio.sleep(0.3)
        assert ann.latest("map_draft")["map"] is None


async def test_a_real_robot_stays_found_on_the_saved_map(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("numba")
    pytest.importorskip("scipy")
    monkeypatch.setattr(asyncio, "to_thread", at_once)
    known = replace(ROOM, homes=(Pose2(-3.0, -2.0, 0.0),))
    begun = Pose2(2.5, 1.0, 2.0)  # far from home
    async with SimulatedRobot(ROOM, home=begun) as sim, connect_async(sim.open) as robot:
        page = Page()
        remote = RemoteWorld(robot, known, print)
        async with (
            page.hosting(robot, RobotScene(known, remote=remote)),
            running(page.run()),
            Browser(make_app(page)) as ann,
        ):
            page.map_editor.folder = tmp_path
            await asyncio.sleep(4.0)
            ann.say("place_robot", x=2.4, y=1.1, heading=2.1)
            await ann.stay(3.0)
            assert ann.latest("navigation")["sure"]
            await edit(ann, "name_place", role="goal", name="Kitchen", x=2.0, y=-1.0)
            assert remote.map is known
            await edit(ann, "save_map", name="lab")
            assert remote.map is not None
            assert remote.map.objects[-1].name == "Kitchen"
            ann.say("goto", x=2.0, y=-1.0, speed=0.6)
            await ann.stay(1.0)
            await arrived(ann, 20.0)
            there = sim.body.robot_in_world
            assert (there.x, there.y) == pytest.approx((2.0, -1.0), abs=0.15)


CHAIR = Table(pose=Pose2(2.5, 1.5), size=(0.5, 0.5), height=0.45, back=0.4)
PILLAR = Cylinder(pose=Pose2(-3.0, 2.0), radius=0.2, height=2.0)
RAMP = Ramp(pose=Pose2(2.5, -2.0), size=(1.0, 1.0), height=0.1)
HALL = WorldFile(
    name="hall",
    wall_height=2.0,
    walls=(
        Wall(points=((-4, -3), (4, -3), (4, 3), (-4, 3)), closed=True),
        Wall(points=((1, 0), (1, 1)), height=0.6),
    ),
    boxes=(Box(pose=Pose2(-3.0, -2.0), size=(0.5, 0.5), height=0.3),),
    solids=(RAMP, PILLAR, CHAIR),
)


async def test_a_world_keeps_its_heights_when_it_is_edited_and_saved(tmp_path: Path) -> None:
    line_map = HALL.line_map()
    relief = HALL.relief(line_map)
    async with playground(line_map=line_map, relief=relief) as the, Browser(the.app) as ann:
        the.page.map_editor.in_thread, the.page.map_editor.folder = at_once, tmp_path
        await asyncio.sleep(0.3)
        drawing = ann.latest("map")["map"]
        assert [solid["kind"] for solid in drawing["solids"]] == ["ramp", "cylinder", "table"]
        await edit(ann, "erase_walls", x0=-2.7, y0=1.7, x1=-3.3, y1=2.3)  # the pillar
        draft = await edit(ann, "draw_wall", x0=-1, y0=-1, x1=-1, y1=1)
        assert [solid["kind"] for solid in draft["map"]["solids"]] == ["ramp", "table"]
        await edit(ann, "save_map", name="lab", format=".toml")
        relief = the.simulation.world.relief
        assert list(relief.solids) == ["box_0", "ramp_0", "table_0"]
        await edit(ann, "name_place", role="goal", name="Door", x=0, y=2)
        await edit(ann, "save_map", name="lab", format=".map")
        assert "Not in it: 1 ramp, 1 table." in ann.latest("told")["message"]
    saved = load_world(tmp_path / "lab.toml")
    assert saved.solids == (RAMP, CHAIR)
    assert saved.boxes == HALL.boxes
    assert saved.walls == (HALL.walls[1],)
    assert saved.wall_height == 2.0
    again = saved.line_map()
    assert len(again.walls) == 4 + 1 + 1 + 4 + 16
    heights = saved.relief(again).heights_of(again).tolist()
    assert heights == [2.0] * 5 + [0.6] + [0.3] * 4 + [0.0] * 16


@pytest.mark.parametrize("name", ["", ".lab", "a/b", "a\\b", "..", "lab\n", "lab\0", 41 * "x"])
def test_no_name_of_a_map_is_a_path(name: str) -> None:
    for asked in (requests.SaveMap, requests.MakeMap):
        with pytest.raises(msgspec.ValidationError):
            msgspec.convert({"name": name, "step": "save"}, asked)
