"""The package says what it lacks, and its page says what is true."""

import re
import shutil
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest

from pioneer3.gym import Reward, Task

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs/how-to/learn.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
LEARNS = "mean reward"
"""A line of the code that learns for some seconds."""


def run(code: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-W", "error", "-c", code]
    return subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)


@pytest.mark.parametrize("missing", ["gymnasium", "pettingzoo"])
def test_a_missing_library_is_named_with_the_extra_that_brings_it(missing: str) -> None:
    done = run(f"import sys; sys.modules[{missing!r}] = None; import pioneer3.gym")
    assert done.returncode == 1
    assert f"import of {missing}" in done.stderr
    assert f"the extra `gym` is missing; run: {ROOT / 'scripts/setup'}" in done.stderr
    assert "--extra gym" in (ROOT / "scripts/setup").read_text("utf-8")


def test_without_a_clone_pip_brings_the_extra(tmp_path: Path) -> None:
    copy = tmp_path / "lib/pioneer3"
    shutil.copytree(ROOT / "src/pioneer3", copy, ignore=shutil.ignore_patterns("web", "*.pyc"))
    before = f"import sys; sys.path.insert(0, {str(copy.parent)!r})"
    done = run(f"{before}; sys.modules['gymnasium'] = None; import pioneer3.gym")
    assert done.returncode == 1
    assert "the extra `gym` is missing; run: " in done.stderr
    assert '"gymnasium>=1.1"' in done.stderr


@pytest.mark.parametrize(
    "code",
    [
        pytest.param(code, id=str(number), marks=pytest.mark.thorough if LEARNS in code else ())
        for number, code in enumerate(BLOCKS)
    ],
)
def test_the_code_of_the_page_runs(code: str) -> None:
    done = run(code)
    assert done.returncode == 0, done.stderr
    rewards = [float(value) for value in re.findall(r"mean reward (\S+)", done.stdout)]
    assert bool(rewards) == (LEARNS in code)
    if rewards:
        assert rewards[-1] > rewards[0] + 2, "nothing was learnt"


@pytest.mark.parametrize("kind", [Task, Reward])
def test_the_page_has_all_options_with_their_defaults(kind: type[Task] | type[Reward]) -> None:
    for field in fields(kind):
        shown = repr(getattr(kind(), field.name)).replace("'", '"')
        if shown.startswith("Reward("):
            shown = "Reward()"
        assert re.search(rf"^\| `{field.name}` \| `?{re.escape(shown)}`? \|", PAGE, re.MULTILINE)
