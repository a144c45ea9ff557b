"""Frames of the 3-D view in headless Chromium: `python -m benchmarks.page_frames_3d`.

The same 20 robots as in `page_frames`, three lasers among them. There is no GPU: the processor
paints every pixel. The first second, in which shaders are compiled, does not count.
"""

import os
import shutil
import sys
from collections.abc import Iterator
from itertools import pairwise
from statistics import median, quantiles

from playwright.sync_api import sync_playwright

from benchmarks.page_frames import LASERS, RECORD, ROBOTS, served
from benchmarks.table import Row

SECONDS = 15.0
COUNT = "(window.pioneer3?.state.scans ?? []).filter(Boolean).length"


def rows(seconds: float = SECONDS) -> Iterator[Row]:
    """Yield the figures."""
    chromium = next(filter(None, map(shutil.which, ("chromium-headless-shell", "chromium"))), None)
    with served() as address, sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=chromium, args=["--no-sandbox", "--enable-unsafe-swiftshader"]
        )
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.add_init_script(RECORD)
        page.add_init_script("""localStorage.setItem("pioneer3.layers", '{"laser": true}')""")
        page.goto(address)
        while page.evaluate(COUNT) < LASERS:
            page.wait_for_timeout(200)
        page.locator("#in-3d").click()
        while not page.evaluate("window.pioneer3.state.solid?.frames"):
            page.wait_for_timeout(20)
        for name in ("fit", "follow"):
            page.locator(f"#{name}").click()
            page.wait_for_timeout(1000)
            page.evaluate("window.frames.at.length = window.frames.took.length = 0")
            page.wait_for_timeout(1000 * seconds)
            frames, solid = page.evaluate("[window.frames, window.pioneer3.state.solid]")
            between = [later - earlier for earlier, later in pairwise(frames["at"])]
            what = f"3-D, {ROBOTS} robots, {name}"
            yield Row(f"{what}: between frames, median", median(between), "ms", None)
            yield Row(f"{what}: 95 % of frames within", quantiles(between, n=20)[-1], "ms", 100)
            yield Row(f"{what}: longest frame", max(between), "ms", 250)
            yield Row(f"{what}: the page's code, median", median(frames["took"]), "ms", None)
            yield Row(f"{what}: draw calls", solid["calls"], "", None)
            yield Row(f"{what}: pixels for a CSS pixel", solid["ratio"], "", None)
        browser.close()


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; no GPU", flush=True)
    missed = 0
    for row in rows():
        print(row, flush=True)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    sys.exit(main())
