"""A serial port without hardware: hosts open a pseudo terminal, a test holds the other end."""

import asyncio
import os
from pathlib import Path

from pioneer3.errors import LinkError
from pioneer3.links.serial import make_pty
from pioneer3.links.stream import StreamLink


class PtyPort:
    """A serial port that does not exist: hosts open :attr:`path`, we hold the other end.

    Attributes:
        path: What a host opens, such as `/dev/pts/3`, or the name that points to it.
        link: The robot's end.
    """

    def __init__(
        self,
        path: str,
        link: StreamLink,
        reading: asyncio.BaseTransport,
        slave: int,
        name: Path | None,
    ) -> None:
        self.path = path
        self.link = link
        self._reading = reading
        self._slave = slave
        self._name = name

    async def close(self) -> None:
        """Unplug: hosts see the port fail and the name vanish."""
        if self._name is not None:
            self._name.unlink(missing_ok=True)
            self._name = None
        if self._slave >= 0:
            os.close(self._slave)
            self._slave = -1
        self._reading.close()
        await self.link.close()


async def open_pty(name: Path | None = None) -> PtyPort:
    """Make a pseudo terminal; `name` becomes a link to it, as udev makes for real ports.

    Raises:
        LinkError: the name is taken, or it cannot be made.
    """
    pair = make_pty()
    master, slave, path = pair.master, pair.slave, pair.path
    if name is not None:
        try:
            name.symlink_to(path)  # noqa: ASYNC240  it does not wait
        except OSError as error:
            os.close(master)
            os.close(slave)
            raise LinkError(f"{name}: cannot make this port: {error.strerror}") from None
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader(loop=loop)
    reading, _ = await loop.connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(reader, loop=loop), os.fdopen(os.dup(master), "rb", 0)
    )
    transport, protocol = await loop.connect_write_pipe(
        lambda: asyncio.StreamReaderProtocol(asyncio.StreamReader(loop=loop), loop=loop),
        os.fdopen(master, "wb", 0),
    )
    writer = asyncio.StreamWriter(transport, protocol, reader, loop)
    link = StreamLink(f"pty:{path}", reader, writer)
    return PtyPort(str(name or path), link, reading, slave, name)
