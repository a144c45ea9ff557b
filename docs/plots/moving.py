"""Takes the moving picture of the README: the page sends a robot to the kitchen."""

import asyncio
from io import BytesIO
from itertools import pairwise

from PIL import Image
from playwright.async_api import Page

from docs.plots.page import offer
from docs.plots.studio import PictureError, Size, Studio, run, seen, until

LOOKED_AT: Size = (1200, 750)
"""Size of the page [CSS px]."""
SCALE = 0.8
"""Pixels of the picture for one of the page."""
FASTER = 10
"""How many times as fast as the robot the picture is; the picture says so."""
PERIOD = 0.1
"""Shortest time between two frames of the picture [s]."""
OFFER, PRESS, END = 1.2, 0.4, 2.2
"""Time of the picture before Go is pressed, while it is, and after the arrival [s]."""
LONGEST = 200.0
"""Longest drive [s]."""
SHORTEST_PICTURE, LONGEST_PICTURE = 8.0, 12.0
"""Bounds on the length of the picture [s]."""
MOST = 2_000_000
"""Largest file [bytes]."""
QUALITIES = 90, 80, 70, 60, 50, 40
"""WebP qualities to try; the first small enough is kept."""
HAND = """([x, y]) => {
  const hand = document.createElement("div");
  hand.id = "hand";
  Object.assign(hand.style, { left: `${x - 15}px`, top: `${y - 15}px` });
  document.body.append(hand);
}"""
"""Draws where the mouse is: pictures of a page do not show it."""
ADD_STYLE = """(style) => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(style);
  document.adoptedStyleSheets.push(sheet);
}"""
"""Adds a style by the way that the page's security policy leaves open."""
STYLE = f"""
#hand {{
  position: fixed; width: 30px; height: 30px; border: 3px solid #b5179e; border-radius: 50%;
  background: #b5179e33; z-index: 99; pointer-events: none;
}}
main.stage.faster::after {{
  content: "{FASTER} times as fast"; position: absolute; right: 16px; bottom: 16px; z-index: 9;
  padding: 6px 12px; border-radius: 8px; background: #1b2533; color: white; font-weight: 600;
}}"""
"""The hand, and what says on the page how fast the picture is."""

Frame = tuple[float, Image.Image]
"""When it was taken [s], and the frame."""


async def kitchen(studio: Studio) -> None:
    """Take frames from the press on Go to the arrival, and join them.

    Raises:
        PictureError: The picture takes too long, is too short or too large.
    """
    async with run() as address:
        desk = await studio.open(address, size=LOOKED_AT, scale=SCALE)
        await until(desk, "state.live && state.pose", "a connected robot on the page")
        await offer(desk, "Kitchen")
        box = await desk.locator("#goto-go").bounding_box()
        assert box is not None
        at = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]
        await desk.mouse.move(*at)
        await desk.evaluate(ADD_STYLE, STYLE)
        await desk.evaluate(HAND, list(at))
        shown = [(OFFER, await frame(desk))]
        await desk.mouse.down()
        shown.append((PRESS, await frame(desk)))
        await desk.mouse.up()
        await desk.evaluate("document.getElementById('hand').remove()")
        await desk.evaluate("document.querySelector('main.stage').classList.add('faster')")
        driven = await followed(desk)
        await seen(desk.get_by_text("Arrived: Kitchen"), "the arrival")
        shown += [((later - at) / FASTER, one) for (at, one), (later, _) in pairwise(driven)]
        shown.append((END, await frame(desk)))
    write(studio, shown)


async def followed(desk: Page) -> list[Frame]:
    """Return frames of the drive, as many as the picture shows, with their times."""
    clock = asyncio.get_running_loop().time
    began, frames = clock(), list[Frame]()
    await until(desk, "state.snapshot.mode === 'goto'", "a robot on its way")
    while await desk.evaluate("window.pioneer3.state.snapshot.mode") == "goto":
        frames.append((clock(), await frame(desk)))
        if clock() - began > LONGEST:
            raise PictureError(f"kitchen: the robot has not arrived after {LONGEST:.0f} s")
        await asyncio.sleep(max(0.0, frames[-1][0] + FASTER * PERIOD - clock()))
    ended = await desk.evaluate("window.pioneer3.state.snapshot.ended")
    if not ended["done"]:
        raise PictureError(f"kitchen: the drive ended: {ended['why']}")
    return [*frames, (clock(), frames[-1][1])]


async def frame(desk: Page) -> Image.Image:
    """Return a picture of the page."""
    return Image.open(BytesIO(await desk.screenshot(scale="device"))).convert("RGB")


def write(studio: Studio, shown: list[Frame]) -> None:
    """Write frames, each with the time for which it is shown, as a small enough file.

    Raises:
        PictureError: Their time or their size is wrong, or no quality is low enough.
    """
    lasts = sum(seconds for seconds, _ in shown)
    if not SHORTEST_PICTURE <= lasts <= LONGEST_PICTURE:
        raise PictureError(
            f"kitchen: it lasts {lasts:.1f} s; change FASTER in docs/plots/moving.py"
        )
    first, *others = [one for _, one in shown]
    for quality in QUALITIES:
        file = BytesIO()
        first.save(
            file,
            "WEBP",
            save_all=True,
            append_images=others,
            duration=[round(1000 * seconds) for seconds, _ in shown],
            loop=0,
            quality=quality,
            method=4,
            minimize_size=True,
        )
        if file.tell() <= MOST:
            break
    else:
        raise PictureError(f"kitchen: {file.tell()} bytes of {MOST} by the lowest quality")
    studio.keep_moving("kitchen", first.size, file.getvalue(), f"{lasts:.1f} s, {quality}")
