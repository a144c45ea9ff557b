"""Schemathesis against the API: no failure, nothing undeclared, no motion without control."""

import asyncio
import json
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import AsyncExitStack
from dataclasses import dataclass
from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from schemathesis import GenerationMode
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from pioneer3 import connect_async
from pioneer3.web.access.sessions import Role, SessionKind
from pioneer3.web.api.operation import Operation, openapi
from pioneer3.web.api.routes import OPERATIONS
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import serve
from tests.support import STAYED, SimulatedRobot

pytestmark = pytest.mark.realtime

EXAMPLES = 8
PATIENCE = 20.0
CHECKS = [
    schemathesis.checks.not_a_server_error,
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
]
FAR = {"X-Forwarded-For": "192.168.0.99"}
"""Makes a request one of the network's."""


def document() -> dict[str, Any]:
    """Return the API's description, without its tokens: ours come by header, or must not."""
    told: dict[str, Any] = json.loads(openapi(OPERATIONS))
    for path in told["paths"].values():
        for one in path.values():
            del one["security"]
    return told


SCHEMA = schemathesis.openapi.from_dict(document())


@dataclass(eq=False)
class Keeper:
    """Has control, and lets the robot stand."""

    name: str = "keeper"


@dataclass
class Target:
    """The product, in a thread of its own."""

    address: str
    sim: SimulatedRobot
    page: Page
    loop: asyncio.AbstractEventLoop

    def token(self, role: Role) -> dict[str, str]:
        """Return the headers of a new script on the network."""

        async def make() -> str:
            return self.page.access.sessions.open("fuzz", role, SessionKind.SCRIPT)[1]

        secret = asyncio.run_coroutine_threadsafe(make(), self.loop).result(PATIENCE)
        return {**FAR, "Authorization": f"Bearer {secret}"}

    @property
    def travelled(self) -> float:
        """How far the wheels have turned, and the robot [m, rad]."""
        pose = self.sim.body.robot_in_world
        return abs(pose.x) + abs(pose.y) + abs(pose.theta)


@pytest.fixture
def target(request: pytest.FixtureRequest) -> Iterator[Target]:
    """Serve a robot; with the parameter `kept`, another has control all the time."""
    ready: Future[Target] = Future()
    loop, leave = asyncio.new_event_loop(), asyncio.Event()
    kept = getattr(request, "param", "") == "kept"

    async def run() -> None:
        async with AsyncExitStack() as stack:
            sim = await stack.enter_async_context(SimulatedRobot())
            robot = await stack.enter_async_context(connect_async(sim.open))
            page, keeper = Page(), Keeper()
            view = await stack.enter_async_context(page.hosting(robot, RobotScene()))
            served = await stack.enter_async_context(serve(page, port=0))
            page.access.urls = ("http://192.168.0.7:8080",)
            ready.set_result(Target(served.http, sim, page, loop))
            while not leave.is_set():
                if kept:
                    assert view.control.take(keeper, keep=True) is None
                await asyncio.sleep(0.1)

    thread = threading.Thread(target=loop.run_until_complete, args=(run(),))
    thread.start()
    try:
        yield ready.result(PATIENCE)
    finally:
        loop.call_soon_threadsafe(leave.set)
        thread.join()
        loop.close()


def attack(target: Target, one: Operation, headers: dict[str, str]) -> None:
    """Ask for one operation with what fits its description, and with what does not."""
    described = SCHEMA[one.path][one.method]
    here = {"robot": 1} if "robot" in one.parameters else None
    cases = [described.as_strategy(path_parameters=here)]
    if one.body is not None:
        bad = GenerationMode.NEGATIVE
        cases.append(described.as_strategy(generation_mode=bad, path_parameters=here))
    if one.parameters:
        cases.append(described.as_strategy())
    for strategy in cases:

        @given(case=strategy)
        @settings(
            max_examples=EXAMPLES,
            derandomize=True,
            database=None,
            suppress_health_check=list(HealthCheck),
        )
        def run(case: schemathesis.Case[Any]) -> None:
            case.call_and_validate(target.address, checks=CHECKS, headers=headers)

        run()


def test_whatever_is_asked_the_answer_is_one_that_the_document_knows(target: Target) -> None:
    for one in OPERATIONS:
        attack(target, one, {})


@pytest.mark.parametrize("target", ["kept"], indirect=True)
def test_a_driver_without_control_moves_nothing(target: Target) -> None:
    headers = target.token(Role.DRIVER)
    for one in OPERATIONS:
        if one.name not in {"take_control", "leave", "revoke_session"}:  # takes over; ends itself
            attack(target, one, headers)
    assert target.travelled < STAYED


def test_a_viewer_moves_nothing(target: Target) -> None:
    headers = target.token(Role.VIEWER)
    for one in OPERATIONS:
        if one.name != "leave":
            attack(target, one, headers)
    assert target.travelled < STAYED


def test_a_stranger_moves_nothing_and_learns_nothing(target: Target) -> None:
    for one in OPERATIONS:
        attack(target, one, FAR)
    assert target.travelled < STAYED
    assert target.page.access.sessions.listed() == []
