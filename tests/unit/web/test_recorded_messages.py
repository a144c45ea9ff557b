"""Messages are the same as when they were recorded, most of them byte for byte. Virtual time.

After a change that is meant, record anew: PIONEER3_MESSAGES_ANEW=1 pytest (this file).
"""

import asyncio
import json
import os
import re
from collections.abc import MutableMapping
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.types import ASGIApp

from pioneer3 import __version__
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject, OccupancyGrid
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN
from tests.unit.web.asking import Script
from tests.unit.web.browser import Browser, Playground, playground

FOLDER = Path(__file__).with_name("recorded")
WALLS = np.array([[3.0, -2.0, 3.0, 2.0], [-2.0, -2.0, 3.0, -2.0], [-2.0, 1 / 3, -2.0, 2.0]])
STATES = np.array([[OCCUPIED, UNKNOWN, FREE], [FREE, FREE, UNKNOWN]], dtype=np.uint8)
MAP = LineMap(
    name="recorded",
    walls=WALLS,
    lines=WALLS[:2],
    grids=(OccupancyGrid(states=STATES, resolution=0.05, origin=Pose2(1.0, 2.0, 0.5)),),
    objects=(
        MapObject(
            kind="ForbiddenArea",
            name="lab",
            pose=Pose2(),
            outline=((7, 7), (9, 7), (9, 9), (7, 9)),
        ),
        MapObject(kind="GoalWithHeading", name="door", pose=Pose2(1.0, 1 / 3, 0.25)),
    ),
)
READS = (
    "robots",
    "robots/1/snapshot",
    "robots/1/control",
    "robots/1/mode",
    "me",
    "sessions",
)
CALLS: tuple[tuple[str, str, object], ...] = (
    ("PUT", "robots/1/control", {}),
    ("PUT", "robots/1/control", {"take_over": True}),
    ("POST", "robots/1/drive", {"v": 0.0}),
    ("PUT", "robots/1/mode", {"mode": "turn", "angle": 1.0}),
    ("DELETE", "robots/1/mode", None),
    ("POST", "robots/1/stop", None),
    ("DELETE", "robots/1/control", None),
    ("POST", "emergency_stop", None),
    ("POST", "robots/1/reset", None),
    ("PUT", "robots/1/motors", {"on": True}),
    ("POST", "robots/9/stop", None),
    ("POST", "robots/1/drive", {"v": "fast"}),
    ("POST", "invitations", {}),
)


class Listener(Browser):
    """Keeps each message as it was sent."""

    def __init__(self, app: ASGIApp) -> None:
        super().__init__(app)
        self.texts: list[str] = []

    async def _send(self, message: MutableMapping[str, Any]) -> None:
        await super()._send(message)
        if message["type"] == "websocket.send":
            text = message["text"].replace(f'"version":"{__version__}"', '"version":"0"')
            self.texts.append(re.sub('"png":"[^"]*"', '"png":""', text))

    def take(self) -> list[str]:
        """Return the first and the last message of each type since the last call."""
        texts, self.texts = self.texts, []
        types = [text.partition(",")[0] for text in texts]
        ends = {types.index(each) for each in types}
        ends |= {len(types) - 1 - types[::-1].index(each) for each in types}
        return [texts[n] for n in sorted(ends)]


async def talk(the: Playground) -> list[str]:
    """Return what a page is told while everything happens that it can be told of."""
    texts = []
    async with Listener(the.app) as ann, Listener(the.app) as bob:
        await ann.stay(1.05)
        texts += ann.take()
        ann.say("watch_details", on=True)
        ann.say("watch_lasers", on=True)
        ann.say("ask_config")
        ann.say("add_box", x=1.5, y=1.0, theta=0.5, length=0.5, width=0.4)
        ann.say("add_person", path=[[-1.0, 1.0], [-1.0, -1.0]])
        await ann.stay(1.05)
        texts += ann.take()
        ann.say("take_control")
        ann.say("start_mode", mode={"mode": "turn", "angle": pi / 2})
        await ann.stay(1.05)
        texts += ann.take()
        bob.say("drive", v=0.2, w=0.0)
        bob.say("stop")
        ann.say("goto", x=9.0, y=9.0)
        ann.say("goto", x=0.5, y=0.0, heading=0.0)
        await ann.stay(1.05)
        texts += ann.take() + bob.take()
        bob.say("take_over")
        bob.say("remove", id=1)
        bob.say("add_robot", model="spaceship", x=0, y=0, theta=0)
        bob.say("pause", paused=True)
        bob.say("mind")
        await bob.stay(1.05)
        bob.say("emergency_stop")
        await bob.stay(0.05)
        texts += ann.take() + bob.take()
    return texts


async def ask(the: Playground) -> list[str]:
    """Return the answers to scripts."""
    script = Script(the.app)
    reads: list[tuple[str, str, object]] = [("GET", path, None) for path in READS]
    texts = []
    for method, path, body in (*reads, *CALLS):
        answer = await script.ask(method, f"/api/{path}", body)
        texts.append(f"{method} {path} {answer.status} {answer.body.decode()}")
    return texts


def compare(name: str, texts: list[str]) -> None:
    """Expect the lines of a file, or write them where that is asked for."""
    file = FOLDER / name
    if os.environ.get("PIONEER3_MESSAGES_ANEW"):
        file.write_text("\n".join(texts) + "\n", encoding="utf-8")
    recorded = file.read_text(encoding="utf-8").splitlines()
    assert list(map(comparable, texts)) == list(map(comparable, recorded))


def comparable(text: str) -> str:
    """Return `text`; answers to scripts, and things of the world, in any order of their fields."""
    if text.startswith('{"type":"world"'):
        return json.dumps(json.loads(text), sort_keys=True)
    if text.startswith("{"):
        return text
    *head, body = text.split(" ", 3)
    return " ".join([*head, json.dumps(json.loads(body or "null"), sort_keys=True)])


async def test_pages_are_told_the_recorded_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pioneer3.web.navigation.installed", lambda: False)
    monkeypatch.setattr(
        "pioneer3.web.navigation.how_to_get", "the extra `{}` is missing".format
    )  # no random numbers
    async with playground(Pose2(0.0, 0.0, 0.0), Pose2(0.0, -1.0, 1.0), line_map=MAP) as the:
        compare("websocket.txt", await talk(the))


async def test_scripts_are_told_the_recorded_bytes() -> None:
    async with playground(line_map=MAP) as the:
        await asyncio.sleep(1.0)
        compare("api.txt", await ask(the))
