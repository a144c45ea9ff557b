"""Virtual time: timeouts of minutes pass in microseconds, and always in the same order.

`--all` runs the thorough tests too; `--physics` moves all simulated robots by MuJoCo.
"""

import asyncio
import gc
import os
import selectors
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest
from hypothesis import settings

from tests.support import PHYSICS

settings.register_profile("patient", deadline=None)
settings.load_profile("patient")

LONGEST = 1000.0
"""Virtual time [s] after which a test hangs."""


MANY_SPINS, RESOLUTION = 1000, 2e-9
"""A clock goes on while tasks are busy: loops fire timers up to 1e-9 s early, and a task whose time
has not quite come would set the same timer for ever [rounds of the loop, s]."""
MOST_SPINS = 100_000
"""Rounds of the loop without a pause after which it will never end."""


class _Autojump(selectors.SelectSelector):
    """When nothing is readable, jump the clock to the next timer instead of sleeping."""

    now = 0.0
    spins = 0

    def __init__(self, longest: float) -> None:
        super().__init__()
        self._longest = longest

    def select(self, timeout: float | None = None) -> list[Any]:
        ready = super().select(0)
        self.spins = 0 if timeout else self.spins + 1
        if self.spins and self.spins % MANY_SPINS == 0:
            self.now += RESOLUTION
        if self.spins == MOST_SPINS:
            raise RuntimeError("hanging: tasks keep each other busy, and no time passes")
        if not ready:
            if timeout is None:
                raise RuntimeError("deadlock: every task waits and no timer is set")
            if self.now <= self._longest < self.now + timeout:
                raise RuntimeError(f"hanging: nothing has ended after {self._longest:g} s")
            self.now += timeout
        return ready


class VirtualTimeLoop(asyncio.SelectorEventLoop):
    """An event loop whose clock jumps from timer to timer."""

    def __init__(self, longest: float = LONGEST) -> None:
        self._autojump = _Autojump(longest)
        super().__init__(self._autojump)

    def time(self) -> float:
        return self._autojump.now


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add `--all` and `--physics`."""
    parser.addoption("--all", action="store_true", help="also run the tests marked `thorough`")
    parser.addoption("--physics", action="store_true", help="move simulated robots by MuJoCo")


def pytest_configure(config: pytest.Config) -> None:
    """Move the robots of all worlds by MuJoCo, if asked to."""
    if config.getoption("--physics"):
        os.environ[PHYSICS] = "1"
        from pioneer3.sim import dynamics, world
        from pioneer3.sim.physics.dynamics import MujocoDynamics

        dynamics.PlanarDynamics = world.PlanarDynamics = MujocoDynamics  # type: ignore


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out the thorough tests unless they are asked for; with physics skip the planar ones."""
    for item in items if config.getoption("--physics") else ():
        if planar := item.get_closest_marker("planar"):
            item.add_marker(pytest.mark.skip(f"on a plane only: {planar.args[0]}"))
    if config.getoption("--all"):
        return
    left_out = [item for item in items if item.get_closest_marker("thorough")]
    config.hook.pytest_deselected(items=left_out)
    items[:] = [item for item in items if item not in set(left_out)]


def pytest_asyncio_loop_factories(
    config: pytest.Config, item: pytest.Item
) -> Mapping[str, Callable[[], asyncio.AbstractEventLoop]]:
    """Every async test runs in virtual time unless marked `realtime`."""
    real = item.get_closest_marker("realtime")
    return {"real": asyncio.new_event_loop} if real else {"virtual": VirtualTimeLoop}


@pytest.fixture(autouse=True, scope="module")
def _no_leaks() -> Iterator[None]:
    """A socket or task that a test leaves open fails a test of its own file, not a later one."""
    yield
    gc.collect()


@pytest.fixture(autouse=True)
def _no_home(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is remembered from one test to the next, or from this machine."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
