"""A client of the API on this computer, where no token is needed."""

from http.client import HTTPConnection, HTTPException
from typing import TypeVar

import msgspec

from pioneer3.errors import CommandError, LinkError
from pioneer3.web.access.middleware import ErrorResponse
from pioneer3.web.api.types import Invitation, SessionInfo

T = TypeVar("T")
PATIENCE = 5.0
"""Longest wait for an answer [s]."""


def sessions(port: int) -> list[SessionInfo]:
    """Return the sessions.

    Raises:
        LinkError, CommandError: nothing answers on this TCP port, or not as asked.
    """
    return _ask(port, "GET", "/api/sessions", list[SessionInfo])


def revoke(port: int, session: str) -> None:
    """End the session of this number; raises as :func:`sessions` does."""
    if not session.isalnum():
        raise CommandError(f"{session}: sessions have numbers; see: pioneer3 access list")
    _ask(port, "DELETE", f"/api/sessions/{session}", type(None))


def invite(port: int, role: str) -> Invitation:
    """Return a new one-time address; raises as :func:`sessions` does."""
    return _ask(port, "POST", "/api/invitations", Invitation, {"role": role})


def _ask(port: int, method: str, path: str, kind: type[T], body: object = None) -> T:
    connection = HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
    data = msgspec.json.encode(body) if body is not None else None
    try:
        connection.request(method, path, data, {"Content-Type": "application/json"})
        response = connection.getresponse()
        answer = response.read()
    except (OSError, HTTPException) as error:
        raise LinkError(
            f"127.0.0.1:{port}: no page is served there ({error}); is pioneer3 run running, and is "
            "this its --web-port?"
        ) from None
    finally:
        connection.close()
    try:
        if response.status >= 400:
            raise CommandError(msgspec.json.decode(answer, type=ErrorResponse).detail)
        return msgspec.json.decode(answer or b"null", type=kind)
    except msgspec.MsgspecError:
        raise LinkError(f"127.0.0.1:{port}: something else answers there") from None
