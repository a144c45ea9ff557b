"""The examples of docs/how-to/extend.md, put into a copy of the package and tried."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import pioneer3
from pioneer3.models import load_model
from pioneer3.navigation.connect import connect_async
from tests.support import SimulatedRobot

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"```(\w+)\n# (\S+)\n(.*?)```", re.DOTALL)


def blocks(heading: str) -> list[tuple[str, str, str]]:
    """Return language, path and text of each block below the heading that begins so."""
    page = (ROOT / "docs/how-to/extend.md").read_text("utf-8")
    (section,) = (part for part in page.split("\n## ") if part.startswith(heading))
    return BLOCK.findall(section)


def changed(text: str, difference: str) -> str:
    """Return `text` with the hunks of a difference, each of which fits in one place."""
    for hunk in difference.split("@@\n"):
        lines = hunk.splitlines(keepends=True)
        before = "".join(line[1:] or "\n" for line in lines if line[0] != "+")
        after = "".join(line[1:] or "\n" for line in lines if line[0] != "-")
        assert text.count(before) == 1, before
        text = text.replace(before, after)
    return text


def extended(heading: str, folder: Path) -> int:
    """Copy the package to `folder` with the example's changes; return the number of files."""
    package = folder / "pioneer3"
    shutil.copytree(Path(pioneer3.__file__).parent, package)
    for language, path, text in blocks(heading):
        file = folder / path.removeprefix("src/")
        if language == "diff":
            file.write_text(changed(file.read_text("utf-8"), text), "utf-8")
        else:
            assert not file.exists()
            file.write_text(text, "utf-8")
    return len(blocks(heading))


@pytest.mark.realtime
@pytest.mark.parametrize(
    ("heading", "tests", "files"),
    [("A behavior", "new_mode.py", 2), ("A sensor", "new_sensor.py", 4)],
)
def test_the_example_works(heading: str, tests: str, files: int, tmp_path: Path) -> None:
    assert extended(heading, tmp_path) == files
    quiet = ["-n", "0", "-p", "no:cacheprovider"]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *quiet, f"tests/examples/{tests}"],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


async def test_a_robot_is_simulated_and_driven_by_its_file(tmp_path: Path) -> None:
    ((_, name, text),) = blocks("A robot model")
    file = tmp_path / name
    file.write_text(text, "utf-8")
    async with (
        SimulatedRobot(model=str(file)) as robot,
        connect_async(robot.open, model=load_model(str(file))) as driver,
    ):
        assert driver.info.model.title == "Pioneer 3-DX with a long deck"
        await driver.move(0.5)
        assert robot.body.robot_in_world.x == pytest.approx(0.5, abs=0.02)
