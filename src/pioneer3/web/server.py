"""Serves the page in the event loop that drives the robot."""

import asyncio
import errno
import logging
import socket
from collections.abc import AsyncIterator, Collection
from contextlib import AsyncExitStack, ExitStack, asynccontextmanager, suppress
from dataclasses import dataclass

import uvicorn

from pioneer3.errors import LinkError, PortBusyError
from pioneer3.links.hosts import ANY, bracketed, is_loopback
from pioneer3.tasks import running
from pioneer3.web.access.certificate import Certificate
from pioneer3.web.access.hosts import others_urls, own_names
from pioneer3.web.app import make_app
from pioneer3.web.connections import BACKLOG, ConnectionLimits, TenfoldFilter, WebServer
from pioneer3.web.page import Page
from pioneer3.web.websocket import BoundedWebSocket

log = logging.getLogger("uvicorn.error")

GOODBYE = 1
"""Longest wait for open pages at the end [s]."""
NEXT_PORTS = 100
"""The port for https is one of so many after the page's."""
FRAME_LIMIT = 4096
"""Longest message taken from a page [bytes]."""


@dataclass(frozen=True, slots=True)
class Served:
    """Addresses of a page that is served; `https` is `None` without a certificate."""

    http: str
    https: str | None = None


@asynccontextmanager
async def serve(
    page: Page,
    *,
    host: str = "127.0.0.1",
    port: int = 8080,
    certificate: Certificate | None = None,
    taken: Collection[int] = (),
) -> AsyncIterator[Served]:
    """Serve `page`; yield its addresses.

    On other machines than this, clients need a session of :attr:`Page.access`. Port 0 takes a free
    one; https comes with a certificate, on the next port that is free and not `taken`.

    Raises:
        PortBusyError, LinkError: the ports cannot be listened on.
    """
    names, limits = own_names(host), ConnectionLimits()
    async with AsyncExitStack() as stack:
        log.addFilter(counting := TenfoldFilter())
        stack.callback(log.removeFilter, counting)
        await stack.enter_async_context(running(page.run()))
        plain = _listen(host, port, stack)
        await stack.enter_async_context(_running(page, names, limits, plain))
        local = bracketed(host) if is_loopback(host) else "127.0.0.1"
        served = Served(f"http://{local}:{_port(plain)}")
        if certificate is not None:
            secure = _listen_next(host, port, taken, stack)
            await stack.enter_async_context(_running(page, names, limits, secure, certificate))
            served = Served(served.http, f"https://{local}:{_port(secure)}")
        page.access.authority = certificate.authority if certificate else None
        page.access.urls = others_urls(
            host,
            _port(plain),
            _port(secure) if certificate else None,
            trusted=certificate is not None and certificate.authority is None,
        )
        yield served


@asynccontextmanager
async def _running(
    page: Page,
    names: frozenset[str],
    limits: ConnectionLimits,
    listeners: list[socket.socket],
    certificate: Certificate | None = None,
) -> AsyncIterator[None]:
    config = uvicorn.Config(
        make_app(page, names),
        ws=BoundedWebSocket,
        ws_max_size=FRAME_LIMIT,
        ws_per_message_deflate=False,
        log_config=None,
        access_log=False,
        lifespan="off",
        proxy_headers=False,
        server_header=False,
        ssl_certfile=certificate.chain if certificate else None,
        ssl_keyfile=certificate.key if certificate else None,
        timeout_graceful_shutdown=GOODBYE,
    )
    server = WebServer(config, limits)
    # its own serve() would take over the signals, which stop the robot
    serving = asyncio.ensure_future(server._serve(listeners))
    try:
        yield
    finally:
        server.should_exit = True
        await asyncio.gather(serving, return_exceptions=True)


def _listen(host: str, port: int, stack: AsyncExitStack) -> list[socket.socket]:
    """Listen at `host`, and always at the loopback address, where no token is needed."""
    with ExitStack() as opened:
        listeners = [opened.enter_context(_bind(host, port))]
        if not is_loopback(host) and host not in ANY:
            listeners.append(opened.enter_context(_bind("127.0.0.1", _port(listeners))))
        stack.enter_context(opened.pop_all())
    return listeners


def _listen_next(
    host: str, port: int, taken: Collection[int], stack: AsyncExitStack
) -> list[socket.socket]:
    """Listen at the next port after `port` that is free; at any if that is 0."""
    if not port:
        return _listen(host, 0, stack)
    last = min(port + NEXT_PORTS, 65535)
    for number in range(port + 1, last + 1):
        if number not in taken:
            with suppress(PortBusyError):
                return _listen(host, number, stack)
    raise PortBusyError(
        f"{host}: no port from {port + 1} to {last} is free for https; "
        "choose another port for the page with --web-port"
    )


def _port(listeners: list[socket.socket]) -> int:
    return int(listeners[0].getsockname()[1])


def _bind(host: str, port: int) -> socket.socket:
    if not 0 <= port <= 65535:
        raise LinkError(f"{host}:{port}: ports are numbers from 1 to 65535")
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        # it listens now, so that the address is known before the server has started
        listener = socket.create_server((host, port), family=family, backlog=BACKLOG)
        listener.setblocking(False)
        # small messages leave at once; connections inherit it
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise PortBusyError(
                f"{host}:{port}: in use; choose another port for the page with --web-port"
            ) from None
        raise LinkError(f"{host}:{port}: cannot serve the page there: {error.strerror}") from None
    return listener
