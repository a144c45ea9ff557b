"""The rules of the house, for every request: our names, our pages, who it is, safe headers."""

import asyncio
from collections.abc import Mapping

from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from pioneer3.web.access.access import Access
from pioneer3.web.access.names import is_ours, is_own_origin
from pioneer3.web.access.sessions import Session
from pioneer3.web.problem import Problem, answer

HEADERS = {
    b"content-security-policy": (
        b"default-src 'self'; object-src 'none'; form-action 'self'; frame-ancestors 'none'; "
        b"base-uri 'none'"
    ),
    b"x-content-type-options": b"nosniff",
    b"x-frame-options": b"DENY",
    b"referrer-policy": b"no-referrer",
    b"cross-origin-resource-policy": b"same-origin",
    b"permissions-policy": b"camera=(), geolocation=(), microphone=(), payment=(), usb=()",
    b"cache-control": b"no-cache",
}
POLICY_VIOLATION = 1008
TOO_MUCH = Problem(429, "too many requests from your address; stops are counted apart")
SECURE = frozenset({"https", "wss"})


class Gate:
    """Refuses what is not for us (DNS rebinding, foreign pages), and says who is asking.

    Args:
        app: Served behind it; finds its caller by :func:`session_of`.
        access: Who is in.
        names: Host names this server goes by.
    """

    def __init__(self, app: ASGIApp, access: Access, names: frozenset[str]) -> None:
        self._app = app
        self._access = access
        self._names = names
        self._turn = asyncio.Lock()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request or WebSocket."""

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", ()), *HEADERS.items()]
            await send(message)

        refused = self._identify(scope) or await self._refuse_flood(scope)
        if refused is None:
            await self._app(scope, receive, send_with_headers)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": POLICY_VIOLATION})
        else:
            headers = {"Connection": "close"} if refused is TOO_MUCH else None
            await answer(refused, headers)(scope, receive, send_with_headers)

    def _identify(self, scope: Scope) -> Problem | None:
        """Note who asks; return why a request goes no further, or `None`."""
        headers = Headers(scope=scope)
        if not is_ours(headers.get("host"), self._names):
            return Problem(421, "this server does not go by that host name")
        if not is_own_origin(headers):
            return Problem(403, "another web page asked for this; only our own may")
        cookie = HTTPConnection(scope).cookies.get(cookie_name(scope))
        session = self._access.session(_peer(scope), headers, cookie)
        scope.setdefault("state", {})["session"] = session
        return None

    async def _refuse_flood(self, scope: Scope) -> Problem | None:
        """Return why this is one request too many, or `None`; all but stops wait for their turn.

        One has its turn in a round of the loop, so that rounds stay short: whatever the crowd, a
        stop takes some of them from the network to the robot.
        """
        session, path = scope["state"]["session"], scope["path"]
        if not self._access.is_stop(session, path):
            async with self._turn:
                await asyncio.sleep(0)
        visit = scope["type"] == "websocket"
        too_much = self._access.is_too_much(_peer(scope), session, path, visit=visit)
        return TOO_MUCH if too_much else None


def _peer(scope: Scope) -> str:
    return str((scope.get("client") or ("", 0))[0])


def session_of(connection: HTTPConnection) -> Session | None:
    """Return whose request or WebSocket this is, `None` for a stranger's."""
    session = connection.scope["state"]["session"]
    assert session is None or isinstance(session, Session)
    return session


def cookie_name(scope: Mapping[str, object]) -> str:
    """Return the cookie of this server: hosts share theirs over all ports.

    Over TLS, the prefix keeps others from planting one.
    """
    server = scope.get("server")
    port = server[1] if isinstance(server, tuple | list) else 0
    return f"__Host-pioneer3-{port}" if scope["scheme"] in SECURE else f"pioneer3-{port}"


def cookie(scope: Mapping[str, object], secret: str) -> str:
    """Return the Set-Cookie header that lets this browser in again; gone when it is closed."""
    secure = "; Secure" if scope["scheme"] in SECURE else ""
    return f"{cookie_name(scope)}={secret}; Path=/; HttpOnly; SameSite=Strict{secure}"
