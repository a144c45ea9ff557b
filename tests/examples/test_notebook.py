"""The example notebooks run from their first cell to their last, as a reader would run them."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

EXAMPLES = Path(__file__).parents[2] / "examples"
Output = dict[str, str]


async def outputs(name: str, monkeypatch: pytest.MonkeyPatch) -> list[Output]:
    """Run a notebook without outputs; return what its cells show."""
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    book = nbformat.read(EXAMPLES / name, as_version=4)
    assert all(not cell.get("outputs") for cell in book.cells)
    await NotebookClient(book, timeout=200, kernel_name="python3").async_execute()
    found = [output for cell in book.cells for output in cell.get("outputs", [])]
    kinds = {"execute_result", "display_data", "stream"}
    assert {output.output_type for output in found} <= kinds
    return [output.get("data") or {output["name"]: output["text"]} for output in found]


@pytest.mark.realtime
@pytest.mark.thorough
@pytest.mark.timeout(300)
async def test_the_notebook_drives_shows_and_plots(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = await outputs("notebook.ipynb", monkeypatch)
    pages = [each["text/html"] for each in shown if "text/html" in each]
    assert len(pages) == 3  # the robot, its live view, the robot at its goal
    assert all('class="robot"' in page for page in pages)
    assert [each for each in shown if "image/png" in each]
    assert "True" in [each.get("text/plain") for each in shown]  # the motion was done


@pytest.mark.realtime
@pytest.mark.thorough
@pytest.mark.timeout(300)
async def test_the_notebook_about_logs_draws_a_drive(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = await outputs("log.ipynb", monkeypatch)
    assert len([each for each in shown if "image/png" in each]) == 2
    assert any("0.75 m/s: move, 1.00 m to go" in each.get("stdout", "") for each in shown)
    assert all("stderr" not in each for each in shown)
