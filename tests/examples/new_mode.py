"""Run by `test_extend.py` with a package that has one more mode, `spin`."""

import asyncio
from math import radians

import pytest

from docs.reference.mode_tables import filled
from pioneer3.behaviors.modes import MODES
from pioneer3.cli.main import app
from pioneer3.web.requests import StartMode, decode
from tests.unit.web.asking import Script
from tests.unit.web.browser import product


def test_the_command_line_has_it() -> None:
    _, given, _ = app.parse_args(["spin", "--rate", "20"], exit_on_error=False, print_error=False)
    assert given.kwargs["rate"] == pytest.approx(radians(20))
    _, given, _ = app.parse_args(["ros1", "spin"], exit_on_error=False, print_error=False)
    with pytest.raises(Exception, match=r"at most 573 deg/s"):
        app.parse_args(["spin", "--rate", "900"], exit_on_error=False, print_error=False)


def test_a_page_may_ask_for_it() -> None:
    asked = decode('{"type": "start_mode", "mode": {"mode": "spin", "rate": 0.3}}')
    assert isinstance(asked, StartMode)
    assert isinstance(asked.mode, MODES[-1])
    with pytest.raises(Exception, match=r"<= 10\.0"):
        decode('{"type": "start_mode", "mode": {"mode": "spin", "rate": 30}}')


async def test_the_api_lists_and_runs_it() -> None:
    async with product() as the:
        script = Script(the.app)
        form = (await script.ask("GET", "/api/modes")).json[-1]
        assert (form["name"], form["title"], form["fields"][0]["unit"]) == ("spin", "Spin", "deg/s")
        asked = await script.ask("PUT", "/api/robots/1/mode", {"mode": "spin", "rate": 0.3})
        assert asked.json["mode"] == "spin"
        await asyncio.sleep(2.0)
        assert the.sim.body.speeds[1] == pytest.approx(0.3, abs=0.05)


def test_the_docs_have_it() -> None:
    assert "| `spin`: Turn on the spot. |" in filled("<!-- made: modes -->\n<!-- end -->\n")
