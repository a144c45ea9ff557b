"""Virtual time: timeouts of minutes pass in microseconds, and always in the same order.

The quick tier of tests runs unless `--all` or `--share` ask for others (`tests/tiers.py`);
`--physics` moves all simulated robots by MuJoCo.
"""

import asyncio
import gc
import os
import selectors
import time
from collections.abc import Callable, Iterator, Mapping
from itertools import chain, count
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from tests import tiers
from tests.costs import Costs
from tests.support import PHYSICS

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
    """Add the options of the tiers, and `--physics`."""
    parser.addoption("--all", action="store_true", help="run the thorough tests too")
    parser.addoption(
        "--share",
        action="store_true",
        help="run only thorough tests: those of what changed lately, and a part of the others",
    )
    parser.addoption("--until", type=float, help="begin no test later [s since 1970]")
    parser.addoption("--physics", action="store_true", help="move simulated robots by MuJoCo")


def pytest_configure(config: pytest.Config) -> None:
    """Choose how many examples are tried; move the robots of all worlds by MuJoCo, if asked to."""
    settings.register_profile("thorough", deadline=None)
    settings.register_profile("quick", deadline=None, max_examples=25)
    settings.load_profile("quick" if _is_quick_run(config) else "thorough")
    config.pluginmanager.register(Costs())
    if config.getoption("--physics"):
        os.environ[PHYSICS] = "1"
        from pioneer3.sim import dynamics, world
        from pioneer3.sim.physics.dynamics import MujocoDynamics

        dynamics.PlanarDynamics = world.PlanarDynamics = MujocoDynamics  # type: ignore


def pytest_collection() -> None:
    """Collect no garbage while tests are collected: nearly all that is made then stays."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Leave what was made so far out of each later search for garbage."""
    gc.freeze()
    gc.enable()


def _is_quick_run(config: pytest.Config) -> bool:
    return not (config.getoption("--all") or config.getoption("--share"))


def _is_named(path: Path, config: pytest.Config) -> bool:
    """Return whether the command names this file, and so wants all tests in it."""
    names = (config.invocation_params.dir / arg.partition("::")[0] for arg in config.args)
    return any(name.resolve() == path for name in names)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Do not import files without a quick test for the quick tier."""
    if not _is_quick_run(config) or not collection_path.match("test_*.py"):
        return None
    is_wanted = tiers.may_be_quick(collection_path) or _is_named(collection_path, config)
    return None if is_wanted else True


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what another tier has; with physics skip the planar ones."""
    are_whole_files = not any("::" in each for each in config.args)
    config.stash[tiers.MISNAMED] = [*tiers.misnamed(items)] if are_whole_files else []
    for item in items if config.getoption("--physics") else ():
        if planar := item.get_closest_marker("planar"):
            item.add_marker(pytest.mark.skip(f"on a plane only: {planar.args[0]}"))
    wanted = _wanted(config, items)
    left_out = set(items).difference(wanted)
    config.hook.pytest_deselected(items=[item for item in items if item in left_out])
    items[:] = _mixed(wanted)


def _mixed(items: list[pytest.Item]) -> list[pytest.Item]:
    """Return `items` in an order that keeps processors busy, file by file.

    Tests in real time wait most of it: while they do, others compute.
    """
    files: dict[Path, list[pytest.Item]] = {}
    for item in items:
        files.setdefault(item.path, []).append(item)
    waiting: list[list[pytest.Item]] = []
    computing: list[list[pytest.Item]] = []
    for tests in files.values():
        in_real_time = any(item.get_closest_marker("realtime") for item in tests)
        (waiting if in_real_time else computing).append(tests)
    # sorted by how far through its own list each is; files that wait come first, not last
    placed = [
        (number / len(some), tests)
        for some in (waiting, computing)
        for number, tests in enumerate(some)
    ]
    return list(chain(*(tests for _, tests in sorted(placed, key=lambda each: each[0]))))


def _wanted(config: pytest.Config, items: list[pytest.Item]) -> list[pytest.Item]:
    if config.getoption("--all"):
        return list(items)
    if config.getoption("--share"):
        files, has_mass = tiers.share(), config.getoption("--physics")
        turn = [item for item in items if _file_of(item) in files]
        return [item for item in turn if has_mass or not tiers.is_quick(item)]
    return [item for item in items if tiers.is_quick(item) or _is_named(item.path, config)]


def _file_of(item: pytest.Item) -> str:
    return item.nodeid.partition("::")[0]


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Leave out what would begin too late."""
    until = item.config.getoption("--until")
    if until is not None and time.time() > until:
        pytest.skip("there is no time left in this share")


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
    gc.freeze()  # what is left, such as modules, is not searched again: that took a tenth of all


@pytest.fixture(scope="session")
def _homes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Return folders for what programs remember; whoever needs one makes it."""
    folder = tmp_path_factory.mktemp("homes")
    return (folder / str(number) for number in count())


@pytest.fixture(autouse=True)
def _no_home(_homes: Iterator[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is remembered from one test to the next, or from this machine."""
    for variable in ("XDG_STATE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.setenv(variable, str(next(_homes)))
    monkeypatch.setenv("PIONEER3_RECORD", "0")
