"""Draw the icons of the app on a home screen from the page's own favicon.

    uv run docs/plots/icons.py

Writes src/pioneer3/web/static/app/*.png with Chromium. Run it after a change of favicon.svg.
"""

import re
import shutil
from pathlib import Path

from playwright.sync_api import sync_playwright

STATIC = Path(__file__).parents[2] / "src/pioneer3/web/static"
ICONS = {
    "icon-192": (192, 1.0),
    "icon-512": (512, 1.0),
    "maskable-512": (512, 0.85),
    "apple-180": (180, 0.95),
}
"""Name -> side [px], and how much of it the robot fills: systems cut shapes out of the last two."""


def draw() -> None:
    """Write every icon."""
    favicon = (STATIC / "favicon.svg").read_text()
    ground = re.search(r'<rect width="32"[^>]*fill="(#\w+)"/>', favicon)
    assert ground is not None
    robot = favicon.replace(ground[0], "").replace("<svg ", '<svg id="robot" ', 1)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        for name, (side, part) in ICONS.items():
            page = browser.new_page(viewport={"width": side, "height": side})
            picture = favicon if part == 1.0 else robot
            color = "transparent" if part == 1.0 else ground[1]
            edge = side * (1 - part) / 2
            style = f"html, body {{ margin: 0; background: {color}; }} svg {{ position: fixed; "
            style += f"inset: {edge}px; width: {side * part}px; }}"
            page.set_content(f"<style>{style}</style>{picture}")
            page.screenshot(path=STATIC / f"app/{name}.png", omit_background=True)
        browser.close()


if __name__ == "__main__":
    draw()
