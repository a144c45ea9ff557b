"""Draws the icons of the app on a home screen from the page's own favicon."""

import re
from io import BytesIO

from PIL import Image

from docs.plots.studio import SOURCE, PictureError, Studio

APP = "src/pioneer3/web/static/app"
PARTS = {"icon-192": 1.0, "icon-512": 1.0, "maskable-512": 0.85, "apple-180": 0.95}
"""How much of each icon the robot fills: systems cut shapes out of the last two."""


async def icons(studio: Studio) -> None:
    """Draw every icon.

    Raises:
        PictureError: The favicon has no ground that can be taken away.
    """
    favicon = (SOURCE / "web/static/favicon.svg").read_text()
    ground = re.search(r'<rect width="32"[^>]*fill="(#\w+)"/>', favicon)
    if ground is None:
        raise PictureError("icons: favicon.svg has no <rect> of the whole width with a colour")
    robot = favicon.replace(ground[0], "").replace("<svg ", '<svg id="robot" ', 1)
    for name, part in PARTS.items():
        side = int(name.rsplit("-", 1)[1])
        page = await studio.open("about:blank", size=(side, side))
        color = "transparent" if part == 1.0 else ground[1]
        style = f"html, body {{ margin: 0; background: {color}; }} svg {{ position: fixed; "
        style += f"inset: {side * (1 - part) / 2}px; width: {side * part}px; }}"
        picture = favicon if part == 1.0 else robot
        await page.set_content(f"<style>{style}</style>{picture}")
        shot = await page.screenshot(omit_background=True)
        studio.keep(f"{APP}/{name}", Image.open(BytesIO(shot)))
