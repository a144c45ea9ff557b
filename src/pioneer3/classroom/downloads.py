"""Files that students load from a class: pioneer3, wheels of its requirements, and programs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Final
from urllib.parse import quote

from pioneer3.distribution import NAME

LESSONS: Final = Path(__file__).with_name("lessons")
"""Programs as they are in the package, for a robot at HERE."""
HERE: Final = "tcp://localhost:8101"
"""Address in the programs, in the place of that of a student's robot."""
KINDS: Final = {".py": "text/x-python", ".ipynb": "application/x-ipynb+json"}
"""Media types of programs, by the ends of their names."""


def lesson_programs() -> dict[str, Path]:
    """Return the programs of the lessons, by name."""
    return {path.name: path for path in sorted(LESSONS.iterdir()) if path.suffix in KINDS}


@dataclass(frozen=True, slots=True)
class Downloads:
    """The files of a class: its wheel, and those of a wheelhouse, `None` without one.

    The port is that of the page without TLS: pip does not trust certificates of ours.
    """

    wheel: Path
    port: int
    wheels: Mapping[str, Path] | None = None
    programs: Mapping[str, Path] = field(default_factory=lesson_programs)

    def command(self, host: str) -> str:
        """Return the line that installs pioneer3 from this computer, at `host` as in a URL."""
        base = f"http://{host}:{self.port}"
        if self.wheels is None:
            return f"pip install {base}/{self.wheel.name}"
        return f"pip install --no-index --trusted-host {host} --find-links {base}/wheels/ {NAME}"

    def program(self, name: str, url: str) -> str:
        """Return a program for the robot at `url`; KeyError if there is none of that name."""
        return self.programs[name].read_text(encoding="utf-8").replace(HERE, url)

    def links(self) -> str:
        """Return the page of links to all wheels."""
        others = self.wheels or {}
        names = {f"../{self.wheel.name}": self.wheel.name, **{each: each for each in others}}
        rows = (f'<a href="{quote(at)}">{escape(name)}</a><br>\n' for at, name in names.items())
        return f"<!doctype html>\n<title>Wheels</title>\n{''.join(rows)}"
