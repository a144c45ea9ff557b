"""Opens links by URL or path."""

import re
from functools import partial
from pathlib import Path
from urllib.parse import urlsplit

from pioneer3.errors import ConfigError
from pioneer3.links.base import Link, Opener

TCP_PORT = 8101
"""Default port of ARCOS simulators and ARIA (protocol.md 1.1)."""
FORMS = "/dev/ttyUSB0, COM3, localhost:8101, tcp://host:8101, replay:FILE"
HOST_AND_PORT = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[\w.-]+):\d+")
BARE_HOST = re.compile(r"localhost|\d+\.\d+\.\d+\.\d+|\[[0-9A-Fa-f:.]+\]", re.IGNORECASE)
"""A computer that can be told from a path or a typing mistake, without a port."""
DEVICE = re.compile(r"(tty|cu\.|rfcomm)\w+[\w.-]*|(serial|pts)/\S+")
"""A serial port without its folder."""
COM_PORT = re.compile(r"COM\d+", re.IGNORECASE)
"""A serial port of Windows."""


async def open_link(url: str, *, baud: int | None = None) -> Link:
    """Open the link that `url` names.

    Args:
        url: `serial:PATH` or just a path, `tcp://HOST[:PORT]`, `HOST:PORT`, `localhost` or an
            address, `replay:FILE`.
        baud: Serial speed to try first.

    Raises:
        ConfigError: the URL does not have one of these forms.
        LinkError: the link does not open; the message has a remedy.
    """
    scheme, rest = split_url(url)
    match scheme:
        case "serial":
            from pioneer3.links.serial import open_serial

            return await open_serial(rest, baud)
        case "tcp":
            from pioneer3.links.stream import open_tcp

            return await open_tcp(*split_host(f"tcp:{rest}"))
        case _:
            return await opener(url)()


def opener(url: str, *, baud: int | None = None, link: str = "robot") -> Opener:
    """Return a function that opens the link again at each call; a recording is not restarted.

    Of a recording with several links, `replay:FILE#NAME` names one; else it is `link`.

    Raises:
        ConfigError: the URL does not have a form of :func:`open_link`, or the recording is wrong.
        PortNotFoundError: there is no such recording.
    """
    scheme, rest = split_url(url)
    if scheme != "replay":
        return partial(open_link, url, baud=baud)
    from pioneer3.links.tap import Replay

    path, mark, name = rest.rpartition("#")
    if mark and not Path(rest).exists():
        return Replay(Path(path), name).open
    return Replay(Path(rest), link).open


def split_url(url: str) -> tuple[str, str]:
    """Return scheme (`serial`, `tcp` or `replay`) and the rest; ConfigError for anything else."""
    if not isinstance(url, str):
        raise ConfigError(f"a port is written as text, such as {FORMS}; not {url!r}")
    scheme, colon, rest = url.partition(":")
    if HOST_AND_PORT.fullmatch(url) or BARE_HOST.fullmatch(url):
        return "tcp", f"//{url}"
    if COM_PORT.fullmatch(url):
        return "serial", url
    if url.startswith(("/", "./", "~")):
        return "serial", str(Path(url).expanduser())
    if colon and scheme in {"serial", "replay"} and rest.strip("/"):
        path = "/" + rest.lstrip("/") if rest.startswith("//") else rest
        return scheme, str(Path(path).expanduser())
    if colon and scheme == "tcp":
        return "tcp", rest
    meant = f", did you mean /dev/{url}?" if DEVICE.fullmatch(url) else ";"
    raise ConfigError(f"{url!r} names no port{meant} use one of: {FORMS}")


def split_host(url: str) -> tuple[str, int]:
    """Return host and port of a `tcp:` URL; ConfigError if there is no host, or no such port."""
    text = url if url.startswith("tcp://") else url.replace("tcp:", "tcp://", 1)
    try:
        parts = urlsplit(text)
        host, port = parts.hostname, TCP_PORT if parts.port is None else parts.port
    except ValueError:
        host, port = None, 0
    if not host or not 0 < port < 65536 or parts.path.strip("/"):
        raise ConfigError(f"{url!r}: expected tcp://HOST:PORT, such as tcp://localhost:{TCP_PORT}")
    return host, port
