"""Looks at the page of simulated robots, and drives them by it as a person does."""

from math import ceil
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageDraw, ImageOps
from playwright.async_api import Page

from docs.plots.studio import PHONE, Size, Studio, product, run, seen, until
from pioneer3.maps import LineMap, read_map

DRIVES = "Math.abs(state.snapshot.twist.v) > 0.25"
"""Condition: the selected robot drives."""
STANDS = "state.snapshot.mode === null && state.snapshot.twist.v === 0"
"""Condition: the selected robot stands."""
WANDERING = 45.0
"""Time until the plots have something to show [s]."""
KNOWN_EARLY = 90.0
"""Ground that is on the map while it is made [m²]."""
EXPLORING = 1500.0
"""Longest time in which the robot sees all of the office [s]."""
PIXELS_PER_METRE = 66.0
"""Scale of a drawn map."""
MARGIN = 0.4
"""Margin around a drawn map [m]."""
BUILT = (1600, 1136)
"""Size of the picture of a map that a robot has made."""
THREE: Size = (1280, 800)
"""Size of pictures of several robots [px]."""


async def first(studio: Studio) -> None:
    """Look at one robot, and offer the kitchen to it."""
    async with run() as address:
        desk = await studio.live(address)
        await studio.take(desk, "page")
        await offer(desk, "Kitchen")
        await studio.take(desk, "page-way")


async def look(studio: Studio) -> None:
    """Let one robot wander, and open the views one after another; stop it, for a phone."""
    async with run() as address:
        desk = await studio.live(address)
        await desk.click(".views [data-view=modes]")
        await desk.select_option("#wander-preset", "aria")
        await desk.click("#wander-start")
        await until(desk, f"{DRIVES} && state.pose.x > 3.8", "a robot that wanders")
        await desk.evaluate("document.querySelectorAll('*').forEach((one) => (one.scrollTop = 0))")
        await studio.take(desk, "page-modes")
        await desk.click(".views [data-view=plots]")
        if studio.wants("page-plots"):
            await desk.wait_for_timeout(1000 * WANDERING)
            await studio.take(desk, "page-plots")
        await desk.click(".views [data-view=robot]")
        await desk.wait_for_timeout(1500)
        await studio.take(desk, "page-robot")
        phone = await studio.live(address, size=PHONE)
        await desk.keyboard.press("k")
        await phone.click("#details")
        await phone.wait_for_timeout(1500)
        await studio.take(phone, "page-phone-stopped")


async def laser(studio: Studio) -> None:
    """Take a picture of the map with the scan of a laser that sees far."""
    async with run("--fit", "laser=utm-30lx") as address:
        desk = await studio.live(address)
        await until(desk, "state.scans[0] > 500", "a scan of the laser")
        await studio.take(desk, "page-laser")


async def camera(studio: Studio) -> None:
    """Open the view of a simulated camera."""
    async with run("--physics", "--fit", "camera=vcc4") as address:
        desk = await studio.live(address)
        await desk.click(".views [data-view=camera]")
        await seen(desk.get_by_text("pixels,"), "a picture of the camera")
        await desk.wait_for_timeout(3000)  # until their number a second is known
        await studio.take(desk, "page-camera")


async def replayed(studio: Studio) -> None:
    """Let a robot wander for a while, stop it in an emergency, and replay its log."""
    with TemporaryDirectory() as folder:
        log = str(Path(folder, "wander.mcap"))
        async with run("--record", log) as address:
            desk = await studio.live(address)
            await desk.click(".views [data-view=modes]")
            await desk.select_option("#wander-preset", "aria")
            await desk.click("#wander-start")
            await until(desk, f"{DRIVES} && state.pose.x > 3.8", "a robot that wanders")
            await desk.keyboard.press("k")
            await until(desk, "state.snapshot.twist.v === 0", "a robot that stands")
            await desk.wait_for_timeout(3000)
        async with product("replay", log) as address:
            desk = await studio.open(address)
            await seen(desk.locator("#replay-play"), "a replay")
            await desk.wait_for_timeout(3000)  # the marks are looked for
            await desk.keyboard.press("End")
            await desk.keyboard.press("Comma")
            await desk.wait_for_timeout(1500)
            await studio.take(desk, "page-replay")


async def several(studio: Studio) -> None:
    """Drive two of three robots, and offer a place to the third."""
    robots = "-r", "p3at-sh:ann", "-r", "p3dx-sh:bob", "-r", "p3dx-sh:cid"
    starts = "--start", "home", "--start", "2.6m,7m,0", "--start", "16m,7.4m,180deg"
    async with run(*robots, *starts, "--fit", "laser=utm-30lx") as address:
        desk = await studio.live(address)
        await desk.click("#layers")
        await desk.check("#layer-laser")
        await desk.click("#legend-close")
        for number, east in enumerate((4.2, 6.0), start=1):
            await desk.keyboard.press(str(number))
            await until(desk, f"state.robot === {number}", f"robot {number}")
            await desk.keyboard.down("ArrowUp")
            await until(desk, f"state.pose.x > {east}", f"robot {number} that drives")
            await desk.keyboard.up("ArrowUp")
        await desk.keyboard.press("3")
        await until(desk, "state.robot === 3", "robot 3")
        await offer(desk, "Kitchen")
        await studio.take(desk, "map", "#canvas")


async def solid(studio: Studio) -> None:
    """Show three robots in three dimensions."""
    robots = "-r", "p3dx-sh:alice", "-r", "p3at-sh:bob", "-r", "p3dx-sh:carol"
    starts = "--start", "home", "--start", "4.3m,4.6m,0", "--start", "2.6m,4.8m,-90deg"
    async with run("--map", "office", *robots, *starts) as address:
        desk = await studio.live(address, size=THREE)
        await desk.keyboard.down("ArrowUp")
        await until(desk, "state.pose.x > 3.6", "a robot that drives")
        await desk.keyboard.up("ArrowUp")
        await until(desk, STANDS, "a robot that stands")
        await desk.click("#in-3d")
        await until(desk, "state.solid && state.solid.frames > 9", "robots in three dimensions")
        await studio.take(desk, "page-3d")


async def together(studio: Studio) -> None:
    """Let five robots form a wedge, and drive it by an arrow."""
    robots = [option for number in range(1, 6) for option in ("-r", f"p3at-sh:p3at-{number}")]
    starts = [option for y in range(-2, 3) for option in ("--start", f"0m,{1.3 * y:g}m,0")]
    async with run("--map", "empty", *robots, *starts) as address:
        desk = await studio.live(address, size=THREE)
        await desk.click("#robots-row button:has-text('p3at-3')")
        for number in (1, 2, 4, 5):
            await desk.keyboard.press(f"Shift+Digit{number}")
        await desk.click(".views [data-view=modes]")
        await desk.select_option("#group-leader", label="p3at-3")
        await desk.click("#form-start")
        formed = (
            "state.chosen.length === 1 && state.robots.filter(r => r.snapshot.mode).length === 4"
        )
        await until(desk, formed, "four robots that form up behind the third")
        await desk.click("#sheet-close")
        await desk.click("#fit")
        await desk.keyboard.down("ArrowUp")
        await until(desk, f"{DRIVES} && state.pose.x > 5", "a wedge that drives")
        await studio.take(desk, "page-together")
        await desk.keyboard.up("ArrowUp")


async def explore(studio: Studio) -> None:
    """Let a robot explore the office, and draw the map that it saves."""
    with TemporaryDirectory() as folder:
        async with run("--fit", "laser=utm-30lx", folder=Path(folder)) as address:
            desk = await studio.live(address)
            await desk.click(".views [data-view=modes]")
            await desk.select_option("#mode-time", label="1 hour")
            await desk.click("#map-begin")
            await desk.click("#map-explore:enabled")
            known = f"parseFloat(document.getElementById('map-state').textContent) > {KNOWN_EARLY}"
            await until(desk, known, "a map of a few rooms", EXPLORING)
            await studio.take(desk, "page-making-a-map")
            if not studio.wants("map-built"):
                return
            explored = desk.get_by_text("Explored: no edge of the map is left.")
            await seen(explored, "the end of exploring", EXPLORING)
            await desk.click("#map-save")
            await seen(desk.get_by_text("Saved lab.map"), "a map that is saved")
        built = drawn(read_map(Path(folder) / "lab.map"))
        studio.keep("map-built", ImageOps.pad(built, BUILT, color="white"))


def drawn(line_map: LineMap) -> Image.Image:
    """Return a picture of the walls of a map, with a cross at its home."""
    least_x, least_y, most_x, most_y = line_map.bounds

    def pixel(x: float, y: float) -> tuple[float, float]:
        return (
            PIXELS_PER_METRE * (x - least_x + MARGIN),
            PIXELS_PER_METRE * (most_y + MARGIN - y),
        )

    width, height = pixel(most_x + MARGIN, least_y - MARGIN)
    picture = Image.new("RGB", (ceil(width), ceil(height)), "white")
    pen = ImageDraw.Draw(picture)
    for x0, y0, x1, y1 in line_map.walls:
        pen.line([pixel(x0, y0), pixel(x1, y1)], "black", 2)
    for home in line_map.homes:
        ahead, left = home.x + 0.5, home.y + 0.12
        pen.line([pixel(home.x - 0.12, home.y), pixel(ahead, home.y)], "green", 3)
        pen.line([pixel(home.x, home.y - 0.12), pixel(home.x, left)], "green", 3)
    return picture


async def offer(desk: Page, place: str) -> None:
    """Offer a place of the map to the selected robot, and wait for the way to it."""
    await desk.click("#goto")
    await desk.select_option("#goto-place", label=place)
    way = f"state.proposal && state.proposal.name === '{place}' && state.proposal.way?.length"
    await until(desk, way, f"a way to {place}")
