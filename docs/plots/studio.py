"""Runs what the pictures show, looks at it in Chromium, and keeps the pictures."""

import asyncio
import re
import shutil
import sys
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import dataclass
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

from PIL import Image
from playwright.async_api import Browser, Locator, Page, async_playwright
from playwright.async_api import TimeoutError as NotInTime

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src/pioneer3"
MADE = ROOT / "docs/plots/made.txt"
"""Names of pictures, each with the digest of what it showed when it was made."""

Size = tuple[int, int]
Scene = Callable[["Studio"], Awaitable[None]]

DESKTOP: Size = (1440, 900)
PHONE: Size = (390, 844)
SEED = "1"
"""Seed of all simulated worlds."""
SIM_PORT, WEB_PORT = "18101", "18080"
"""Pictures show ports, so these are always the same."""
PATIENCE = 90.0
"""How long a busy machine may take for anything that is waited for [s]."""
COLOURS = 256
"""Size of a picture's palette, by which the file is a third as large."""


class PictureError(Exception):
    """A picture cannot be made, or does not show what it should."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """One picture: a row of the table.

    Attributes:
        file: Its path in the project.
        shows: A sentence about it.
        scene: The function that makes it, often with others.
        size: Width and height [px]; `None` of drawings, which fit any.
        parts: Files and folders of `src/pioneer3` that give it its looks.
        visible: Selectors of elements that have to be on the page when it is taken.
    """

    file: str
    shows: str
    scene: Scene
    size: Size | None
    parts: tuple[str, ...]
    visible: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The name by which it is asked for, such as `page` or `tutorial/drive-first`."""
        return self.file.removeprefix("docs/images/").rsplit(".", 1)[0]

    @property
    def path(self) -> Path:
        """Its file."""
        return ROOT / self.file

    def digest(self) -> str:
        """Return a digest of the files that give it its looks.

        Raises:
            PictureError: One of its parts is not there any more.
        """
        digest = sha256()
        for part in self.parts:
            path = SOURCE / part
            files = sorted(path.rglob("*.*")) if path.is_dir() else [path]
            if not path.exists():
                raise PictureError(f"{self.file}: src/pioneer3/{part} is not there; mend its row")
            for file in files:
                if file.suffix != ".pyc":
                    digest.update(file.read_bytes())
        return digest.hexdigest()[:16]


def made() -> dict[str, str]:
    """Return the digest that each picture had when it was made."""
    lines = MADE.read_text().splitlines() if MADE.exists() else []
    return dict(line.split(" ", 1) for line in lines)


def note(*pictures: Picture) -> None:
    """Keep the digests of pictures that show what there is now."""
    digests = made() | {one.name: one.digest() for one in pictures}
    MADE.write_text("".join(f"{name} {digests[name]}\n" for name in sorted(digests)))


class Studio:
    """Makes the wanted pictures of the table, and takes no others."""

    def __init__(self, browser: Browser, wanted: Mapping[str, Picture]) -> None:
        self.browser = browser
        self._wanted = dict(wanted)
        self._complaints: list[str] = []
        self._began = time.monotonic()

    @property
    def missing(self) -> list[str]:
        """Names of the wanted pictures that have not been made yet."""
        return list(self._wanted)

    def wants(self, *names: str) -> bool:
        """Return whether one of these pictures is still to be made."""
        return any(name in self._wanted for name in names)

    async def open(
        self,
        address: str,
        *,
        size: Size = DESKTOP,
        scheme: Literal["light", "dark"] = "light",
        scale: float = 1.0,
    ) -> Page:
        """Open a page of the program; a narrow one is a phone's."""
        context = await self.browser.new_context(
            viewport={"width": size[0], "height": size[1]},
            color_scheme=scheme,
            device_scale_factor=scale,
            has_touch=size[0] < 600,
            reduced_motion="reduce",
        )
        page = await context.new_page()
        page.on("pageerror", lambda error: self._complaints.append(str(error)))
        page.set_default_timeout(1000 * PATIENCE)
        await page.goto(address)
        return page

    async def live(self, address: str, *, size: Size = DESKTOP, dark: bool = False) -> Page:
        """Open the page of a robot, and wait until it shows where that is."""
        page = await self.open(address, size=size, scheme="dark" if dark else "light")
        await until(page, "state.live && state.pose", "a connected robot on the page")
        await page.wait_for_timeout(1500)  # the map comes into view
        return page

    async def take(self, page: Page, name: str, of: str = "") -> None:
        """Take a picture of the page, or of an element, unless nobody wants it.

        Raises:
            PictureError: Something is missing on the page, or it has complained.
        """
        if name not in self._wanted:
            return
        for selector in self._wanted[name].visible:
            await seen(page.locator(selector), f"{name}: {selector}")
        if self._complaints:
            raise PictureError(f"{name}: the page complains: {'; '.join(self._complaints)}")
        shot = await (page.locator(of).screenshot() if of else page.screenshot())
        self.keep(name, Image.open(BytesIO(shot)))

    def keep(self, name: str, image: Image.Image) -> None:
        """Write a picture with as few colours as it needs.

        Raises:
            PictureError: It has not the size that its row says.
        """
        if name not in self._wanted:
            return
        if image.size != (size := self._wanted[name].size):
            raise PictureError(f"{name}: it is {image.size}, and its row says {size}")
        if image.mode == "RGBA" and image.getchannel("A").getextrema() == (255, 255):
            image = image.convert("RGB")
        if image.mode == "RGB":
            image = with_few_colours(image)
        image.save(self._wanted[name].path, optimize=True)
        self.kept(name)

    def keep_moving(self, name: str, size: Size, file: bytes, how: str) -> None:
        """Write a moving picture.

        Raises:
            PictureError: It has not the size that its row says.
        """
        if size != self._wanted[name].size:
            raise PictureError(f"{name}: it is {size}, and its row says {self._wanted[name].size}")
        self._wanted[name].path.write_bytes(file)
        self.kept(name, how)

    def kept(self, name: str, how: str = "") -> None:
        """Note that the file of a picture has been written, with what it shows."""
        if name not in self._wanted:
            return
        picture = self._wanted.pop(name)
        note(picture)
        took = time.monotonic() - self._began
        kilobytes = picture.path.stat().st_size / 1000
        tell(f"{took:5.0f} s  {picture.file}  {kilobytes:.0f} kB {how}: {picture.shows}")


def tell(text: str) -> None:
    """Write a line to the terminal."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def with_few_colours(image: Image.Image) -> Image.Image:
    """Return a picture with a palette."""
    return image.quantize(COLOURS, Image.Quantize.MEDIANCUT, kmeans=3, dither=Image.Dither.NONE)


@asynccontextmanager
async def studio(wanted: Mapping[str, Picture]) -> AsyncIterator[Studio]:
    """Run Chromium while the block lasts.

    Raises:
        PictureError: There is no Chromium.
    """
    chromium = shutil.which("chromium-headless-shell") or shutil.which("chromium")
    if chromium is None:
        raise PictureError("Chromium is missing: apt-get install chromium-headless-shell")
    options = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--hide-scrollbars"]
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(executable_path=chromium, args=options)
        yield Studio(browser, wanted)
        await browser.close()


@asynccontextmanager
async def product(*command: str, folder: Path | None = None) -> AsyncIterator[str]:
    """Run a command of the program that serves pages, in a folder; yield their address.

    Raises:
        PictureError: It warns, or ends without an address; says its words.
    """
    simulates = ("--sim-port", SIM_PORT) if command[0] != "replay" else ()
    with TemporaryDirectory() as empty:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "pioneer3", *command, "--web-port", WEB_PORT, *simulates),
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
            cwd=folder or empty,
        )
        assert process.stdout is not None
        try:
            said = ""
            async for line in process.stdout:
                said += line.decode()
                if "WARNING" in said:
                    raise PictureError(f"pioneer3 {' '.join(command)}: {said}")
                if found := re.search(r"http://[^\s/]+", line.decode()):
                    yield found[0]
                    break
            else:
                raise PictureError(f"pioneer3 {' '.join(command)} ended: {said}")
        finally:
            if process.returncode is None:
                process.terminate()
            await process.wait()


def run(*options: str, folder: Path | None = None) -> AbstractAsyncContextManager[str]:
    """Run the page of simulated robots; yield its address."""
    return product("run", "--no-announce", "--seed", SEED, *options, folder=folder)


async def until(page: Page, condition: str, what: str, seconds: float = PATIENCE) -> None:
    """Wait for a condition on `state`, the state of the page.

    Raises:
        PictureError: It does not come true; says `what` is missing.
    """
    script = f"() => {{ const {{ state }} = window.pioneer3; return Boolean({condition}); }}"
    try:
        await page.wait_for_function(script, timeout=1000 * seconds)
    except NotInTime as error:
        raise PictureError(f"there is not {what} after {seconds:.0f} s") from error


async def seen(element: Locator, what: str, seconds: float = PATIENCE) -> None:
    """Wait until an element is on the page.

    Raises:
        PictureError: It does not come; says `what` is missing.
    """
    try:
        await element.first.wait_for(state="visible", timeout=1000 * seconds)
    except NotInTime as error:
        raise PictureError(f"{what} is not there after {seconds:.0f} s") from error
