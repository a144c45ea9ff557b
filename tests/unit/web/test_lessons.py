"""The tasks on the projector's page are those of the teacher's guide."""

import re
from html import unescape
from pathlib import Path

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "src/pioneer3/web/static/pages/lessons.html"
GUIDE = ROOT / "docs/how-to/lessons.md"


def without_marks(text: str) -> str:
    """Return the words of HTML or Markdown."""
    return unescape(re.sub(r"</?(b|code)>|\*\*|`", "", text))


def test_the_projector_shows_the_tasks_of_the_guide_in_its_order() -> None:
    page, guide = PAGE.read_text("utf-8"), GUIDE.read_text("utf-8")
    shown = [without_marks(task) for task in re.findall(r"<li>(.+?)</li>", page)]
    lessons = guide.partition("## 1 ")[2].partition("## With real robots")[0]
    written = [without_marks(task) for task in re.findall(r"^\d\. (.+)$", lessons, re.MULTILINE)]
    assert len(shown) == 15
    assert shown == written
