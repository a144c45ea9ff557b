"""`pioneer3 sim`: its options. The rest is in `tests/e2e/test_commands.py`."""

import logging
from collections.abc import Iterator

import pytest

from pioneer3.cli import sim as sim_module
from pioneer3.cli.main import execute


@pytest.fixture
def simulated(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[tuple[str, str, int]]]:
    """Note what would be simulated: map, robot, port."""
    seen: list[tuple[str, str, int]] = []

    async def note(map_name: str, robot: str, port: int) -> int:
        seen.append((map_name, robot, port))
        return 0

    monkeypatch.setattr(sim_module, "_simulate", note)
    log = logging.getLogger("pioneer3")
    level = log.level
    yield seen
    log.setLevel(level)


def test_without_options_an_at_drives_in_the_office(simulated: list[tuple[str, str, int]]) -> None:
    assert execute(["sim"]) == 0
    assert simulated == [("office", "p3at-sh", 8101)]


@pytest.mark.parametrize(
    "line", ["sim --map lab.map --robot p3dx-sh --port 8102", "sim -m lab.map -r p3dx-sh -p 8102"]
)
def test_every_option_has_a_long_and_a_short_form(
    line: str, simulated: list[tuple[str, str, int]]
) -> None:
    assert execute(line.split()) == 0
    assert simulated == [("lab.map", "p3dx-sh", 8102)]


@pytest.mark.parametrize("port", [0, 1, 65535])
def test_every_port_there_is_may_be_given(port: int, simulated: list[tuple[str, str, int]]) -> None:
    assert execute(["sim", "-p", str(port)]) == 0
    assert simulated[0][2] == port


@pytest.mark.parametrize("port", ["-1", "65536", "70000", "nan", ""])
def test_no_other_port_may(port: str, simulated: list[tuple[str, str, int]]) -> None:
    assert execute(["sim", "-p", port]) == 2
    assert simulated == []


def test_only_verbose_tells_who_comes_and_goes(simulated: list[tuple[str, str, int]]) -> None:
    execute(["sim"])
    assert not logging.getLogger("pioneer3").isEnabledFor(logging.INFO)
    execute(["sim", "-v"])
    assert logging.getLogger("pioneer3").isEnabledFor(logging.INFO)
