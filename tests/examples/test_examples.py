"""Every example and the README's Python run, as a reader would run them, on the simulator."""

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
WITH_RAY = ROOT / "examples/08_learn_with_ray.py"
EXAMPLES = sorted({*(ROOT / "examples").glob("*.py")} - {WITH_RAY})
COMPUTE = {"05_learn", "06_many_robots", "09_sweep"}
"""Examples that keep a processor busy for long; the unit tests have every call that they make."""


@contextmanager
def simulator() -> Iterator[str]:
    """Run a simulator on a free port."""
    command = [sys.executable, "-m", "pioneer3", "sim", "-p", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        yield process.stdout.readline().split()[-1]
        process.terminate()


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    with simulator() as url:
        yield url


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=pytest.mark.thorough) if path.stem in COMPUTE else path
        for path in EXAMPLES
    ],
    ids=lambda path: path.stem,
)
def test_the_example_runs(path: Path, url: str) -> None:
    done = subprocess.run(
        [sys.executable, str(path), url], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert len(path.read_text().splitlines()) <= 40


@pytest.mark.thorough
@pytest.mark.skipif(find_spec("ray") is None, reason="no ray here: python -m pip install ray")
def test_two_workers_of_ray_learn_to_find_goals(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    monkeypatch.delenv("RAY_ADDRESS", raising=False)
    done = subprocess.run(
        [sys.executable, str(WITH_RAY)], capture_output=True, text=True, timeout=110, check=False
    )
    assert done.returncode == 0, done.stderr
    rewards = [float(each) for each in re.findall(r"mean reward (\S+) of 512", done.stdout)]
    assert len(rewards) == 10
    assert rewards[-1] > rewards[0] + 2
    assert len(WITH_RAY.read_text().splitlines()) <= 40


def blocks_of(page: str, url: str) -> list[str]:
    """Return the Python on a page, for the simulator of this test."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
    return [block.replace("tcp://localhost:8101", url) for block in blocks]


def run(code: str) -> str:
    """Run `code`; return what it prints."""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout


def test_the_code_in_the_readme_runs(url: str) -> None:
    blocks = blocks_of("README.md", url)
    assert len(blocks) == 1
    assert run(blocks[0]).endswith(") Nothing is asked of it.\n")


@pytest.mark.thorough  # it drives for long
def test_the_code_about_notebooks_runs_but_for_its_views() -> None:
    with simulator() as url:  # at home: it drives 1.3 m
        blocks = blocks_of("docs/how-to/notebook.md", url)
        assert len(blocks) == 5
        kept = [block for block in blocks if "view()" not in block]
        run("\n".join([*kept, "assert len(speeds) > 20", "robot.close()"]))


def test_the_code_about_the_python_api_runs(url: str) -> None:
    blocks = blocks_of("docs/reference/python-api.md", url)
    run("\n".join(f"exec({block!r}, {{}})" for block in blocks))
