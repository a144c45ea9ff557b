"""A new mode is its own file, and a line in the tuple of all modes."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import pioneer3

ROOT = Path(__file__).parents[2]
SPIN = '''"""The mode that spins."""

from typing import Annotated, ClassVar

from msgspec import Meta

from pioneer3.behaviors import Desire, Ranked, Situation, Stack
from pioneer3.behaviors.modes.mode import Mode, TurnRate
from pioneer3.limits import Limits


class SpinAction:
    name = "spin"

    def __init__(self, rate: float) -> None:
        self._rate = rate

    def decide(self, situation: Situation) -> Desire:
        return Desire(v=0.0, w=self._rate, reason="spinning")


class Spin(Mode, frozen=True, tag="spin"):
    """Turn on the spot."""

    title: ClassVar[str] = "Spin"
    doing: ClassVar[str] = "spins"
    start: ClassVar[str] = "Start to spin"

    rate: Annotated[TurnRate, Meta(description="Counter-clockwise.")] = 0.5

    def stack(self, limits: Limits) -> Stack:
        return Stack.of("spin", 20, [Ranked(50, SpinAction(self.rate))], self.doing)
'''


@pytest.mark.realtime
def test_a_mode_of_one_file_and_one_line_is_offered_everywhere(tmp_path: Path) -> None:
    package = tmp_path / "pioneer3"
    shutil.copytree(Path(pioneer3.__file__).parent, package)
    modes = package / "behaviors/modes"
    (modes / "spin.py").write_text(SPIN, "utf-8")
    listed = (modes / "__init__.py").read_text("utf-8")
    listed = listed.replace("\n    Turn,\n)", "\n    Turn,\n    Spin,\n)")
    listed = listed.replace(
        "\nMODES:", "\nfrom pioneer3.behaviors.modes.spin import Spin\n\nMODES:"
    )
    (modes / "__init__.py").write_text(listed, "utf-8")
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-n",
            "0",
            "-p",
            "no:cacheprovider",
            "tests/e2e/new_mode.py",
        ],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "4 passed" in done.stdout
