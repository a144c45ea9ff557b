"""Places of a map on the command line."""

from types import SimpleNamespace
from typing import Any

import pytest

from pioneer3.cli.main import Exit, execute
from pioneer3.cli.places import require_place
from pioneer3.errors import MotionError


async def test_a_robot_that_is_not_where_it_was_said_to_be_names_the_options_that_tell() -> None:
    async def find() -> bool:
        return False

    lost: Any = SimpleNamespace(find=find, estimate=SimpleNamespace(reason="no wall fits"))
    with pytest.raises(MotionError) as told:
        await require_place(lost, "goto Lobby", looks=False)
    text = str(told.value)
    assert text.startswith("goto Lobby: it is not sure where the robot is: no wall fits; ")
    assert all(word in text for word in ("--start PLACE", "--start unknown", "--look-around"))


def test_goto_nowhere_says_what_to_give(capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(["goto"]) == Exit.USAGE
    assert "give a name of the map" in capsys.readouterr().err
