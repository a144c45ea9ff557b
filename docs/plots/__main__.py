"""Make the pictures of the book from the running program, all of them or those named.

    .venv/bin/python -m docs.plots [NAME...]     from the project's root; all take half an hour
    .venv/bin/python -m docs.plots --list        the table
    .venv/bin/python -m docs.plots --stale       those that may be older than what they show
    .venv/bin/python -m docs.plots --same NAME   you looked: this one still shows what there is

It needs Chromium, and for sonar-angle matplotlib: uv run --with matplotlib python -m docs.plots.
"""

import argparse
import asyncio
import sys

from playwright.async_api import Error

from docs.plots.studio import Picture, PictureError, made, note, studio, tell
from docs.plots.table import PICTURES, ROWS


def stale() -> list[Picture]:
    """Return the pictures whose looks may have changed since they were made."""
    digests = made()
    return [row for row in ROWS if digests.get(row.name) != row.digest()]


async def make(names: list[str]) -> list[str]:
    """Make pictures, scene by scene; return what went wrong."""
    wanted = {name: PICTURES[name] for name in names or PICTURES}
    scenes = list(dict.fromkeys(row.scene for row in wanted.values()))
    problems = []
    async with studio(wanted) as at_work:
        for scene in scenes:
            before = [name for name in at_work.missing if wanted[name].scene is scene]
            tell(f"{', '.join(before)} ...")
            try:
                await scene(at_work)
            except (PictureError, Error, ExceptionGroup, OSError) as error:
                problems.append(f"{scene.__module__}.{scene.__name__}: {error}")
                tell(problems[-1])
        if at_work.missing:
            problems.append(f"not made: {', '.join(at_work.missing)}")
    return problems


def main() -> int:
    """Do what the command line says; return its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m docs.plots",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="such as page-way; none: all")
    parser.add_argument("--list", action="store_true", help="tell what each picture shows")
    parser.add_argument("--stale", action="store_true", help="name those to be made anew")
    parser.add_argument("--same", action="store_true", help="keep pictures that are as they were")
    asked = parser.parse_args()
    if unknown := [name for name in asked.names if name not in PICTURES]:
        parser.error(f"no picture has the name {unknown[0]}; --list names all")
    if asked.list:
        for row in ROWS:
            size = " x ".join(map(str, row.size or ("any size",)))
            tell(f"{row.file}  {size}: {row.shows}")
        return 0
    if asked.stale:
        names = " ".join(row.name for row in stale())
        if names:
            tell(f"may be older than what they show: python -m docs.plots {names}")
        return int(bool(names))
    if asked.same:
        note(*(PICTURES[name] for name in asked.names))
        return 0
    problems = asyncio.run(make(asked.names))
    for problem in problems:
        sys.stderr.write(problem + "\n")
    return int(bool(problems))


if __name__ == "__main__":
    sys.exit(main())
