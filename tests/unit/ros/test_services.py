"""Services whose node is busy."""

import asyncio
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace
from typing import Any

import pytest

from pioneer3.ros.node.services import SERVICES, Services

pytestmark = pytest.mark.realtime


@pytest.mark.parametrize("name", ["enable_motors", "disable_motors"])
async def test_only_a_stop_is_done_after_the_answer_that_it_is_not(
    name: str,
) -> None:
    switched: list[bool] = []

    def set_motors(*, on: bool) -> None:
        switched.append(on)

    arbiter = SimpleNamespace(set_motors=set_motors)
    pilot = SimpleNamespace(auto_enable=True)
    robot: Any = SimpleNamespace(arbiter=arbiter, supervisor=SimpleNamespace(pilot=pilot))
    services = Services(
        robot, sonar=True, diagnose=tuple, moved=lambda: None, warn=lambda sentence: None
    )
    (service,) = (each for each in SERVICES if each.standard == name)
    with ThreadPoolExecutor(1) as pool:
        waiting = pool.submit(services._serve, service, None)
        response: Any = waiting.result(timeout=10.0)  # meanwhile the loop is busy
    assert not response.success
    assert "has not come to it" in response.message
    await asyncio.sleep(0.1)
    assert switched == ([False] if service.stops else [])
