"""A fuzzer at the page's WebSocket: it goes on answering, and nothing moves without control."""

import asyncio
import json
from math import inf, nan

import msgspec
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pioneer3.web import requests
from pioneer3.web.access.sessions import Role, SessionKind
from tests.unit.web.asking import ELSEWHERE, LAN
from tests.unit.web.browser import Browser, playground

TYPES = [kind.__struct_config__.tag for kind in requests.AnyRequest.__args__]
FIELDS = sorted(
    {f.name for kind in requests.AnyRequest.__args__ for f in msgspec.structs.fields(kind)}
)
numbers = st.one_of(
    st.floats(-3, 3), st.integers(-2, 20), st.sampled_from([nan, inf, -inf, 1e308, 2**70, -0.0])
)
values = st.recursive(
    st.one_of(numbers, st.booleans(), st.none(), st.text(max_size=20)),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner),
    max_leaves=8,
)
FITTING = {
    "drive": st.fixed_dictionaries({"v": numbers, "w": numbers}),
    "motors": st.fixed_dictionaries({"on": st.booleans()}),
    "hand_over": st.fixed_dictionaries({"to": st.integers(0, 9)}),
    "ping": st.fixed_dictionaries({"t": numbers}),
}
near = st.sampled_from(TYPES).flatmap(
    lambda type_: st.builds(
        lambda fields: json.dumps({"type": type_, **fields}),
        FITTING.get(type_, st.dictionaries(st.sampled_from(FIELDS), values, max_size=6)),
    )
)
drives = st.builds(
    lambda v, w: json.dumps({"type": "drive", "v": v, "w": w}), st.floats(-1, 1), st.floats(-2, 2)
)
frames = st.one_of(
    near,
    drives,
    drives,
    near.map(lambda text: text[: len(text) // 2]),
    values.map(json.dumps),
    st.text(max_size=200),
    st.binary(max_size=50),
)
hard = settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow], derandomize=True)


async def attack(role: Role, sent: list[str | bytes]) -> None:
    """Send everything as a client without control; then the socket must still answer."""
    async with playground() as the, Browser(the.app) as keeper:
        keeper.say("take_control")
        _, secret = the.page.access.sessions.open("fuzz", role, SessionKind.BROWSER)
        before = the.simulation.body.robot_in_world
        cookie = f"pioneer3-8080={secret}"
        async with Browser(the.app, host=LAN, peer=ELSEWHERE, cookie=cookie) as mallory:
            for frame in sent:
                if isinstance(frame, bytes):
                    mallory.say_bytes(frame)
                elif "take_over" not in frame:  # who may drive may take over: that is no crash
                    mallory.say_text(frame)
                await asyncio.sleep(0.07)  # as long as a page pauses
            await asyncio.sleep(1.0)
            mallory.say("ping", t=42)
            await asyncio.sleep(0.1)
            assert mallory.closed is None
            assert mallory.latest("pong")["t"] == 42
            assert the.control.holder is not None
            assert the.control.holder.name == keeper.latest("people")["name"]
        assert the.simulation.body.robot_in_world == before


@hard
@given(st.lists(frames, min_size=10, max_size=40))
async def test_a_driver_without_control_moves_nothing(sent: list[str | bytes]) -> None:
    await attack(Role.DRIVER, sent)


@hard
@given(st.lists(frames, min_size=10, max_size=40))
async def test_a_viewer_moves_nothing(sent: list[str | bytes]) -> None:
    await attack(Role.VIEWER, sent)
