"""The example notebook runs from its first cell to its last, as a reader would run it."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

PAGE = Path(__file__).parents[2] / "examples/notebook.ipynb"


@pytest.mark.realtime
@pytest.mark.thorough
@pytest.mark.timeout(300)
async def test_the_notebook_drives_shows_and_plots(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    book = nbformat.read(PAGE, as_version=4)
    assert all(not cell.get("outputs") for cell in book.cells)
    await NotebookClient(book, timeout=200, kernel_name="python3").async_execute()
    outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
    assert {output.output_type for output in outputs} <= {"execute_result", "display_data"}
    shown = [output["data"] for output in outputs]
    pages = [each["text/html"] for each in shown if "text/html" in each]
    assert len(pages) == 3  # the robot, its live view, the robot at its goal
    assert all('class="robot"' in page for page in pages)
    assert [each for each in shown if "image/png" in each]
    assert "True" in [each.get("text/plain") for each in shown]  # the motion was done
