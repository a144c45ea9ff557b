"""Checks of every request: host name, origin, session and rate. Safe headers, error responses."""

import asyncio
from collections.abc import Mapping
from http import HTTPStatus

import msgspec
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.requests import HTTPConnection, Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from pioneer3.web.access.access import Access
from pioneer3.web.access.hosts import is_ours, is_own_origin
from pioneer3.web.access.sessions import LoginSession

MEDIA_TYPE = "application/problem+json"
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
SECURE = frozenset({"https", "wss"})


class ErrorResponse(msgspec.Struct, frozen=True):
    """The reason for not carrying out a request (RFC 9457, problem details).

    Attributes:
        status: The HTTP status.
        detail: The reason, for people.
        title: The status in words.
    """

    status: int
    detail: str
    title: str = ""


def respond(error: ErrorResponse, headers: dict[str, str] | None = None) -> Response:
    """Return the HTTP response for `error`."""
    titled = msgspec.structs.replace(error, title=HTTPStatus(error.status).phrase)
    return Response(
        msgspec.json.encode(titled),
        error.status,
        headers={"WWW-Authenticate": "Bearer"} if error.status == 401 else headers,
        media_type=MEDIA_TYPE,
    )


def respond_to_http_exception(_: Request, error: Exception) -> Response:
    """Return the response for a path or a method that does not exist."""
    assert isinstance(error, HTTPException)
    return respond(ErrorResponse(error.status_code, error.detail), dict(error.headers or {}))


def respond_to_failure(_: Request, error: Exception) -> Response:
    """Return the response for a failure of the server; the log has the rest."""
    return respond(ErrorResponse(500, "an error of the server; its log says more"))


TOO_MUCH = ErrorResponse(429, "too many requests from your address; stops are counted apart")


class AccessMiddleware:
    """Refuses requests by DNS rebinding, of other pages and above the rate; finds their sessions.

    The application behind it finds the session with :func:`session_of`; `names` are this server's.
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
                headers = dict(message.get("headers", ()))
                ours = ((name, text) for name, text in HEADERS.items() if name not in headers)
                message["headers"] = [*message.get("headers", ()), *ours]
            await send(message)

        refused = self._identify(scope) or await self._refuse_flood(scope)
        if refused is None:
            await self._app(scope, receive, send_with_headers)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": POLICY_VIOLATION})
        else:
            headers = {"Connection": "close"} if refused is TOO_MUCH else None
            await respond(refused, headers)(scope, receive, send_with_headers)

    def _identify(self, scope: Scope) -> ErrorResponse | None:
        """Find the session of a request; return the refusal, or `None`."""
        headers = Headers(scope=scope)
        if not is_ours(headers.get("host"), self._names):
            return ErrorResponse(421, "this server does not go by that host name")
        if not is_own_origin(headers):
            return ErrorResponse(403, "another web page asked for this; only our own may")
        cookie = HTTPConnection(scope).cookies.get(cookie_name(scope))
        session = self._access.session(_peer(scope), headers, cookie)
        scope.setdefault("state", {})["session"] = session
        return None

    async def _refuse_flood(self, scope: Scope) -> ErrorResponse | None:
        """Return the refusal of a request above the rate, or `None`; all but stops take turns.

        One request has its turn in each round of the loop, so that rounds stay short: with any
        number of requests, a stop takes a few rounds from the network to the robot.
        """
        session, path = scope["state"]["session"], scope["path"]
        if not self._access.is_stop(session, path):
            async with self._turn:
                await asyncio.sleep(0)
        visit = scope["type"] == "websocket"
        too_much = self._access.exceeds_rate(_peer(scope), session, path, visit=visit)
        return TOO_MUCH if too_much else None


def _peer(scope: Scope) -> str:
    return str((scope.get("client") or ("", 0))[0])


def session_of(connection: HTTPConnection) -> LoginSession | None:
    """Return the session of a request or a WebSocket, or `None`."""
    session = connection.scope["state"]["session"]
    assert session is None or isinstance(session, LoginSession)
    return session


def cookie_name(scope: Mapping[str, object]) -> str:
    """Return the cookie of this server: hosts share theirs over all ports.

    Over TLS, the prefix keeps others from planting one.
    """
    server = scope.get("server")
    port = server[1] if isinstance(server, tuple | list) else 0
    return f"__Host-pioneer3-{port}" if scope["scheme"] in SECURE else f"pioneer3-{port}"


def cookie(scope: Mapping[str, object], secret: str, seconds: float | None = None) -> str:
    """Return the Set-Cookie header that lets this browser in again.

    It is kept for so many `seconds`; `None` until the browser is closed.
    """
    secure = "; Secure" if scope["scheme"] in SECURE else ""
    age = "" if seconds is None else f"; Max-Age={seconds:.0f}"
    return f"{cookie_name(scope)}={secret}; Path=/; HttpOnly; SameSite=Strict{age}{secure}"
