"""Reads one MJPEG camera on the network while its pictures are wanted."""

import asyncio
import logging
import os
import ssl
from collections.abc import AsyncGenerator, Iterator
from contextlib import contextmanager
from math import inf
from netrc import NetrcParseError, netrc
from secrets import token_hex
from typing import Final

from pioneer3.errors import DeviceError, LinkError
from pioneer3.mjpeg import (
    MOST_PARTS,
    TOO_FAST,
    CameraUrl,
    Credentials,
    Frame,
    Parser,
    authorization,
    parse_url,
    request,
)
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.reports import RATE_WINDOW, ArrivalRate
from pioneer3.robot.supervisor import Connection, ConnectionStatus, Feed
from pioneer3.state import Picture

log = logging.getLogger(__name__)

OPEN_PATIENCE = 3.0
"""For a camera to take the connection [s]."""
SILENCE = 8.0
"""A camera without a picture for so long is lost [s]."""
LINGER = 5.0
"""The connection is kept for so long after the last picture was wanted [s]."""
BACK_OFF: Final = (0.3, 0.5, 1.0, 2.0, 4.0)
"""Pauses before the attempts to reconnect [s]; the last one repeats."""
READ = 64 << 10
"""Taken at once [bytes]."""
PATIENCE = 6.0
"""Longest wait for a picture [s]."""
YOUNG = 1.0
"""An older picture is not the newest one [s]."""


class CameraDriver:
    """One camera, connected to while somebody wants pictures, and shortly after that.

    Attributes:
        url: Of its stream, such as `http://192.168.0.90/axis-cgi/mjpg/video.cgi`.
        latest: The last picture, or `None`; look at its stamp.
        broken: Number of parts of the stream that were no pictures.

    Raises:
        ConfigError: The URL is wrong.
    """

    def __init__(self, url: str | CameraUrl) -> None:
        self._at = parse_url(url) if isinstance(url, str) else url
        self.url = str(self._at)
        self.status: Feed[ConnectionStatus] = Feed()
        self.latest: Picture | None = None
        self.pictures = self.broken = 0
        self._feed: Feed[Picture] = Feed()
        self._clock = asyncio.get_running_loop().time
        self._rate = ArrivalRate()
        self._wanted = 0
        self._last_wanted = -inf
        self._wish = asyncio.Event()
        self._failure, self._failures = "", 0

    @property
    def connected(self) -> bool:
        """Whether pictures come."""
        status = self.status.latest
        return status is not None and status.connection is Connection.CONNECTED

    @property
    def presence(self) -> Presence:
        """There is one: it was asked for. The reason tells its state."""
        if self._failure:
            return Presence(True, f"The camera is lost: {self._failure}.")
        if self.connected:
            return Presence(True, f"The camera at {self.url} sends {self.rate:.0f} pictures/s.")
        return Presence(True, f"The camera at {self.url} is asked when its pictures are wanted.")

    @property
    def rate(self) -> float:
        """Pictures in the last second [1/s]."""
        return self._rate.at(self._clock())

    @contextmanager
    def wanted(self) -> Iterator[None]:
        """Keep :attr:`latest` new during the block."""
        self._wanted += 1
        self._wish.set()
        try:
            yield
        finally:
            self._wanted -= 1
            self._last_wanted = self._clock()
            if not self._wanted:
                self._wish.clear()

    async def values(self) -> AsyncGenerator[Picture, None]:
        """Yield each picture; the newest when the reader is slow."""
        with self.wanted():
            async for picture in self._feed.values():
                yield picture

    async def picture(self, max_age: float = YOUNG, patience: float = PATIENCE) -> Picture:
        """Return the newest picture, or the next one if that is older than `max_age` [s].

        Raises:
            DeviceError: None came for `patience` [s]; the message has the reason.
        """
        with self.wanted():
            latest = self.latest
            if latest is not None and self._clock() - latest.stamp <= max_age:
                return latest
            try:
                async with asyncio.timeout(patience):
                    return await anext(self._feed.values())
            except (TimeoutError, StopAsyncIteration):
                raise DeviceError(f"No picture for {patience:g} s. {self.presence}") from None

    async def run(self) -> None:
        """Connect while pictures are wanted, and again after every loss; ends by cancellation."""
        try:
            while True:
                await self._wish.wait()
                self._publish(Connection.CONNECTING, "connecting")
                try:
                    await self._serve_once()
                    self._failure, self._failures = "", 0
                    self._publish(Connection.CLOSED, "nobody looks")
                except LinkError as error:
                    await self._lose(str(error))
                except Exception as error:  # it must not end the robot beside it
                    log.exception("%s failed", self.url)
                    await self._lose(f"{self.url}: failed: {error!r}")
        finally:
            self._publish(Connection.CLOSED, "closed")
            self._feed.close()
            self.status.close()

    async def _serve_once(self) -> None:
        """Take pictures until nobody wants any; LinkError, with the reason, if it is lost."""
        login = ""
        while True:
            parser = Parser()
            try:
                await self._take_stream(parser, login)
            except LinkError as error:
                if login and parser.wants_login:
                    problem = f"it refuses the user or the password of {_logins()}"
                    raise LinkError(f"{self.url}: {problem}") from None
                challenge = parser.challenge
                user = login_of(self._at.host) if challenge else None
                if user is None:
                    raise LinkError(f"{self.url}: {error}") from None
                login = authorization(self._at, user, challenge, token_hex(8))
                if not login:
                    problem = f"it wants a login by {challenge[:40]!r}: let it take Digest or Basic"
                    raise LinkError(f"{self.url}: {problem}") from None
            else:
                return
            finally:
                self.broken += parser.broken

    async def _take_stream(self, parser: Parser, login: str) -> None:
        at = self._at
        try:
            async with asyncio.timeout(OPEN_PATIENCE):
                reader, writer = await asyncio.open_connection(
                    at.host, at.port, ssl=ssl.create_default_context() if at.secure else None
                )
        except TimeoutError:
            raise LinkError(f"no answer within {OPEN_PATIENCE:g} s") from None
        except OSError as error:
            raise LinkError(_plain(error)) from None
        try:
            writer.write(request(at, login))
            await self._read(reader, parser)
        except OSError as error:
            raise LinkError(_plain(error)) from None
        finally:
            writer.transport.abort()

    async def _read(self, reader: asyncio.StreamReader, parser: Parser) -> None:
        """Publish pictures until nobody wants any; LinkError if they end, or are none."""
        last = since = self._clock()
        before = 0
        while self._wanted or self._clock() < self._last_wanted + LINGER:
            try:
                async with asyncio.timeout_at(last + SILENCE):
                    data = await reader.read(READ)
            except TimeoutError:
                raise LinkError(_silent(parser)) from None
            if not data:
                raise LinkError("the camera closed the connection")
            for frame in parser.receive(data):
                last = self._clock()
                self._take(frame, last)
            if parser.parts - before > MOST_PARTS:
                raise LinkError(TOO_FAST)
            if self._clock() - since >= RATE_WINDOW:
                since, before = self._clock(), parser.parts
            await asyncio.sleep(0)  # a full buffer is read without a pause

    def _take(self, frame: Frame, now: float) -> None:
        self.pictures += 1
        if not self.connected:
            self._failure, self._failures = "", 0
            self._publish(Connection.CONNECTED, "pictures come")
        self.latest = Picture(stamp=now, sequence=self.pictures, jpeg=frame.jpeg, view=frame.view)
        self._rate.add(now)
        self._feed.publish(self.latest)

    async def _lose(self, reason: str) -> None:
        self._failure = reason
        self._publish(Connection.LOST, reason)
        pause = BACK_OFF[min(self._failures, len(BACK_OFF) - 1)]
        self._failures += 1
        await asyncio.sleep(pause)

    def _publish(self, connection: Connection, message: str) -> None:
        status = ConnectionStatus(connection, message)
        if self.status.latest != status and connection is not Connection.CONNECTING:
            log.info("%s: %s: %s", self.url, connection, message)
        self.status.publish(status)


def login_of(host: str) -> Credentials | None:
    """Return the user and password for a camera, from the file NETRC or ~/.netrc.

    Raises:
        LinkError: The file cannot be read, others may read it, or a login cannot be sent.
    """
    path = os.environ.get("NETRC")
    try:
        found = netrc(path).authenticators(host)
    except FileNotFoundError:
        return None
    except (OSError, NetrcParseError) as error:
        raise LinkError(f"{_logins()}: {error}") from None
    if found is None:
        return None
    login = Credentials(found[0], found[2])
    if not (login.user + login.password).isprintable() or {":", '"'} & {*login.user}:
        raise LinkError(f"{_logins()}: a login for {host} that cannot be sent")
    return login


def _logins() -> str:
    """Return the name of the file with the logins."""
    return os.environ.get("NETRC") or "~/.netrc"


def _silent(parser: Parser) -> str:
    if parser.broken:
        return f"it sends parts that are no JPEG pictures: {parser.broken} of them"
    return f"no picture for {SILENCE:g} s"


def _plain(error: OSError) -> str:
    if error.errno and str(error.strerror).startswith("Connect call failed"):  # asyncio's own words
        return os.strerror(error.errno)
    return error.strerror or str(error) or type(error).__name__
