"""A client of ACTS, a colour tracker in a process of its own (facts.md 8.12)."""

import asyncio
from collections.abc import AsyncGenerator
from functools import partial

from pioneer3.acts import PORT, REQUEST, BlobPicture, PictureReader
from pioneer3.errors import DeviceError, LinkError, PortNotFoundError
from pioneer3.links import Link, Opener, open_link
from pioneer3.robot.devices.presence import Presence

PATIENCE = 2.0
"""Longest wait for one picture [s]; ACTS sends 30 a second."""


class Acts:
    """Requests pictures from an ACTS server; `latest` is `None` before one and after a failure."""

    def __init__(self, where: str | Opener = f"tcp://127.0.0.1:{PORT}") -> None:
        """`where` is a URL, or a function that opens a link."""
        self.latest: BlobPicture | None = None
        self._open = where if callable(where) else partial(open_link, where)
        self._where = "ACTS" if callable(where) else f"ACTS at {where}"
        self._failure = ""

    @property
    def presence(self) -> Presence:
        """Whether it runs: only its pictures show that."""
        if self.latest is not None:
            return Presence(True, f"{self._where} sends pictures.")
        if self._failure:
            return Presence(False, self._failure)
        return Presence(None, f"Nobody has asked {self._where} yet.")

    async def pictures(self) -> AsyncGenerator[BlobPicture, None]:
        """Yield one picture after the other; a slow reader requests fewer.

        Raises:
            DeviceError: there is no ACTS, or it does not answer; the message has the reason.
        """
        try:
            link = await self._open()
            try:
                reader = PictureReader()
                while True:
                    self.latest = await self._next(link, reader)
                    yield self.latest
            finally:
                await link.close()
        except PortNotFoundError:
            raise self._failed(
                f"{self._where}: nobody listens there; does it run? Simulators have one: --acts."
            ) from None
        except LinkError as error:
            raise self._failed(f"{self._where}: {error}; does it run?") from None
        except TimeoutError:
            raise self._failed(f"{self._where} has sent no picture for {PATIENCE:g} s.") from None
        except ValueError as error:
            raise self._failed(f"What answers is not ACTS 1.2 or 2.0: {error}.") from None

    async def _next(self, link: Link, reader: PictureReader) -> BlobPicture:
        async with asyncio.timeout(PATIENCE):
            await link.write(REQUEST)
            while data := await link.read():
                pictures = reader.feed(data)
                if pictures:
                    return pictures[-1]
        raise LinkError("it closed the connection")

    def _failed(self, why: str) -> DeviceError:
        self.latest, self._failure = None, why
        return DeviceError(why)
