"""Driving after a colour that ACTS sees (facts.md 8.12)."""

import asyncio
from contextlib import suppress

from pioneer3.acts import BlobPicture
from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import ColorFollow, ColorPatch
from pioneer3.behaviors.modes import by_hand as stacks
from pioneer3.demo.columns import ColumnRow
from pioneer3.demo.mode import Context, DemoMode, Description
from pioneer3.errors import DeviceError
from pioneer3.robot.devices import Presence

WIDTH = 160
"""Width of ACTS's pictures [pixels]; it does not tell."""
HEIGHT = 120
"""Height of ACTS's pictures [pixels]; it does not tell."""
PAUSE = 2.0
"""Before ACTS is looked for again [s]."""
CHANNELS = frozenset("12345678")


def acts(context: Context, about: Description) -> DemoMode:
    """Return the mode that follows a colour."""
    chase = _ColorMode(context)
    return DemoMode(
        about, presence=chase.presence, begin=chase.begin, on_key=chase.on_key, row=chase.row
    )


class LatestBlobs:
    """The blobs of the last picture, as actions want them."""

    def __init__(self) -> None:
        self._picture: BlobPicture | None = None
        self._stamp = 0.0

    def take(self, picture: BlobPicture | None, stamp: float) -> None:
        """Look at another picture, taken at `stamp` [s]; `None` is none."""
        self._picture, self._stamp = picture, stamp

    def largest(self, channel: int) -> ColorPatch | None:
        """Return the largest blob of a channel, or `None`."""
        blobs = self._picture.channel(channel) if self._picture else ()
        if not blobs:
            return None
        return ColorPatch(
            x=(blobs[0].x + 0.5) / WIDTH * 2 - 1,
            y=1 - (blobs[0].y + 0.5) / HEIGHT * 2,
            area=blobs[0].area / (WIDTH * HEIGHT),
            stamp=self._stamp,
        )


class _ColorMode:
    def __init__(self, context: Context) -> None:
        self._context = context
        self._eyes = LatestBlobs()
        self._follow = ColorFollow(self._eyes)
        self._stack: Stack | None = None

    def presence(self) -> Presence:
        """ACTS may be started at any time."""
        now = self._context.acts.presence
        return Presence(now.there or None, now.reason)

    def begin(self) -> None:
        self._follow.moving = False
        self._context.work(self._watch())

    def on_key(self, key: str) -> bool:
        match key.lower():
            case _ if key in CHANNELS:
                self._follow.channel = int(key)
            case "z":
                self._follow.moving = True
                self._stack = stacks.color_follow(self._follow)
                self._context.start(self._stack)
            case "space":
                self._context.robot.arbiter.stop()
            case "x":
                self._follow.acquiring = not self._follow.acquiring
            case _:
                return False
        return True

    def row(self) -> ColumnRow:
        follow = self._follow
        seen = self._eyes.largest(follow.channel) is not None
        return ColumnRow(
            tail=(
                f"Channel: {follow.channel}"
                f"  movement {'on' if self._context.drives(self._stack) else 'off'}"
                f"  {'actively' if follow.acquiring else 'passively'} acquiring"
                f"  {'blob in sight' if seen else 'no blob in sight'}"
            )
        )

    async def _watch(self) -> None:
        clock = asyncio.get_running_loop().time
        while True:
            with suppress(DeviceError):  # the presence tells it
                async for picture in self._context.acts.pictures():
                    self._eyes.take(picture, clock())
            self._eyes.take(None, clock())
            await asyncio.sleep(PAUSE)
