"""Pages of the book do what they say: a reader at an empty computer does all of it."""

import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Final

import pytest

from tests.book.page import Block, Comment, Picture, commands, steps
from tests.book.reader import ROOT, alone, expected
from tests.ros1.master import has_ros

LONGEST: Final = 900
"""Time to read a page on a busy machine [s]."""
READ: Final = (
    "tutorial/drive.md",
    "tutorial/program.md",
    "tutorial/sonar.md",
    "tutorial/wander.md",
    "tutorial/kitchen.md",
    "tutorial/real-robot.md",
    "tutorial/ros1.md",
    "tutorial/ros2.md",
    "tutorial/class.md",
    "how-to/behave.md",
    "how-to/calibrate.md",
    "how-to/camera.md",
    "how-to/class.md",
    "how-to/csv.md",
    "how-to/demo.md",
    "how-to/drive.md",
    "how-to/extend.md",
    "how-to/from-aria.md",
    "how-to/install.md",
    "how-to/laser.md",
    "how-to/lessons.md",
    "how-to/look-back.md",
    "how-to/make-a-map.md",
    "how-to/models.md",
    "how-to/navigate.md",
    "how-to/obstacles.md",
    "how-to/onboard-computer.md",
    "how-to/robots.md",
    "how-to/share.md",
    "how-to/simulate.md",
    "how-to/speed-limits.md",
    "troubleshooting/does-not-move.md",
    "troubleshooting/index.md",
    "troubleshooting/no-port.md",
    "troubleshooting/unknown-robot.md",
)
"""Pages that are read here, below docs."""


@cache
def why_not() -> str:
    """Return the reason that there can be no computer alone here; empty if there can."""
    try:
        done = subprocess.run(alone(["true"]), capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return "no unshare here: apt-get install util-linux"
    return done.stderr.strip()


@pytest.mark.realtime
@pytest.mark.timeout(LONGEST)
@pytest.mark.parametrize("page", READ, ids=lambda page: Path(page).stem)
def test_a_page_does_what_it_says(page: str) -> None:
    if reason := why_not():
        pytest.skip(reason)
    if page.endswith("ros1.md") and not has_ros():
        pytest.skip("ROS 1 is not installed; scripts/test installs it")
    done = subprocess.run(
        [sys.executable, "-m", "tests.book.reader", f"docs/{page}"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr + done.stdout


PAGE: Final = """# A page

<!-- beside: pioneer3 sim -->

<!-- goes on -->
```sh title="Second terminal"
pioneer3 run \\
  --lan
# a comment

cat > a <<EOF
one
EOF
```

![A picture](a.png)

```python
print(1)
```
"""


def test_a_page_is_a_list_of_what_its_reader_does() -> None:
    beside, block, picture, python = steps(PAGE)
    assert beside == Comment("beside", "pioneer3 sim", 3)
    assert isinstance(block, Block)
    assert (block.title, block.notes, block.line) == ("Second terminal", {"goes on": ""}, 6)
    assert [*commands(block)] == ["pioneer3 run \\\n  --lan\n", "cat > a <<EOF\none\nEOF\n"]
    assert picture == Picture("a.png", 16)
    assert isinstance(python, Block)
    assert (python.language, python.notes) == ("python", {})


def test_a_comment_about_a_block_stands_before_it() -> None:
    with pytest.raises(ValueError, match="line 3: a block has to follow <!-- fails -->"):
        list(steps("<!-- fails -->\n\nWords.\n"))


@pytest.mark.parametrize(
    ("line", "said", "agrees"),
    [
        ("at 1.25 m", "at -3 m", True),
        ("at 1 m", "at one m", False),
        ("p3at ... done", "p3at (p3at-sh), 12 V: done", True),
        ("p3at ... done", "p3at done", True),
        ("a (b) c", "a (b)\r\n  c", True),
        ("on tcp://127.0.0.1:8101", "on tcp://127.0.0.1:8102", True),
    ],
)
def test_words_have_to_be_there_and_numbers_may_differ(line: str, said: str, agrees: bool) -> None:
    assert bool(expected([line]).search(said)) is agrees
