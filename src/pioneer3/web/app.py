"""Routes and the rules of the house: who may load the page, and from where."""

from ipaddress import ip_address
from pathlib import Path
from urllib.parse import urlsplit

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from pioneer3.web.page import Page
from pioneer3.web.visitor import Visitor

STATIC = Path(__file__).with_name("static")
HEADERS = {
    b"content-security-policy": b"default-src 'self'; frame-ancestors 'none'; base-uri 'none'",
    b"x-content-type-options": b"nosniff",
    b"referrer-policy": b"no-referrer",
    b"cache-control": b"no-cache",
}
LOCAL_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})
POLICY_VIOLATION = 1008


class HouseRules:
    """Refuses names that are not ours (DNS rebinding), and sends the security headers."""

    def __init__(self, app: ASGIApp, names: frozenset[str]) -> None:
        self._app = app
        self._names = names

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] == "http" and not is_ours(Request(scope).headers.get("host"), self._names):
            await PlainTextResponse("unknown host name", 421)(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", ()), *HEADERS.items()]
            await send(message)

        await self._app(scope, receive, send_with_headers)


def is_ours(host: str | None, names: frozenset[str]) -> bool:
    """Whether `host`, a header such as `localhost:8080`, is a name this server goes by.

    So is every number: a name is what DNS rebinding needs.
    """
    try:
        name = urlsplit(f"//{host}").hostname or ""
        return name in names or bool(ip_address(name))
    except ValueError:
        return False


def make_app(page: Page, names: frozenset[str] = LOCAL_NAMES) -> Starlette:
    """Return the application; it answers to `names` only."""

    async def index(_: Request) -> Response:
        return FileResponse(STATIC / "index.html")

    async def visit(socket: WebSocket) -> None:
        host, origin = socket.headers.get("host"), socket.headers.get("origin")
        same = origin in {None, f"http://{host}", f"https://{host}"}
        if not is_ours(host, names) or not same:
            await socket.close(POLICY_VIOLATION)
            return
        await Visitor(page, socket).serve()

    return Starlette(
        routes=[
            Route("/", index),
            WebSocketRoute("/ws", visit),
            Mount("/static", StaticFiles(directory=STATIC)),
        ],
        middleware=[Middleware(HouseRules, names=names)],
    )
