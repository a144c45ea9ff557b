"""Serves the page in the event loop that drives the robot."""

import asyncio
import errno
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import uvicorn

from pioneer3.errors import LinkError, PortBusyError
from pioneer3.runtime.robot import Robot
from pioneer3.runtime.scene import Scene
from pioneer3.web.app import LOCAL_NAMES, make_app
from pioneer3.web.page import Page

GOODBYE = 1
"""How long open pages are waited for at the end [s]."""
FRAME_LIMIT = 4096
"""Longest message taken from a page [bytes]."""


@asynccontextmanager
async def serve_page(
    robot: Robot, scene: Scene, *, host: str = "127.0.0.1", port: int = 8080
) -> AsyncIterator[str]:
    """Serve the live page; yield its address.

    Args:
        robot: What is shown and driven.
        scene: What surrounds it.
        host: Address to listen on; anything but loopback lets the whole network drive.
        port: TCP port; 0 takes a free one.

    Raises:
        PortBusyError, LinkError: the port cannot be listened on.
    """
    with _bind(host, port) as listener:
        names = LOCAL_NAMES | {host.lower()} | _own_names(host)
        config = uvicorn.Config(
            make_app(Page(robot, scene), names),
            ws="websockets-sansio",
            ws_max_size=FRAME_LIMIT,
            log_config=None,
            access_log=False,
            lifespan="off",
            timeout_graceful_shutdown=GOODBYE,
        )
        server = uvicorn.Server(config)
        # its own serve() would take the signals away from those who stop the robot
        running = asyncio.ensure_future(server._serve([listener]))
        try:
            yield f"http://{_shown(host)}:{listener.getsockname()[1]}"
        finally:
            server.should_exit = True
            await asyncio.gather(running, return_exceptions=True)


def _bind(host: str, port: int) -> socket.socket:
    if not 0 <= port <= 65535:
        raise LinkError(f"{host}:{port}: ports are numbers from 1 to 65535")
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        # it listens now, so that the address may be told before the server has started
        listener = socket.create_server((host, port), family=family)
        # small messages leave at once; connections inherit it
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise PortBusyError(
                f"{host}:{port}: in use; choose another port for the page with --web-port"
            ) from None
        raise LinkError(f"{host}:{port}: cannot serve the page there: {error.strerror}") from None
    return listener


def _own_names(host: str) -> frozenset[str]:
    """Return the names this machine goes by when it listens beyond loopback."""
    if host in LOCAL_NAMES:
        return frozenset()
    name = socket.gethostname().lower()
    return frozenset({name, f"{name}.local"})


def _shown(host: str) -> str:
    return f"[{host}]" if ":" in host else host
