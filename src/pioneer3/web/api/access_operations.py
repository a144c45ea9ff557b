"""The operations of the API on sessions, invitations and tokens."""

import asyncio
from typing import Literal

from starlette.datastructures import Headers

from pioneer3.web.access.access import device
from pioneer3.web.access.invitations import TERM, pairing_url, svg
from pioneer3.web.access.middleware import ErrorResponse, cookie
from pioneer3.web.access.sessions import LoginSession, Role, SessionKind
from pioneer3.web.api import types
from pioneer3.web.api.operation import ApiRequest, operation

NOT_HERE = "only on the computer that runs this, at its own address http://127.0.0.1"


def pair(request: ApiRequest, body: types.PairingRequest) -> types.Me | ErrorResponse:
    """Open a session with a one-time token; the answer sets a cookie."""
    access = request.page.access
    wait = access.pairing_limiter.wait(request.address)
    if wait:
        return ErrorResponse(429, f"too many attempts; try again in {wait:.0f} s")
    name = body.name or device(Headers(raw=request.scope["headers"]).get("user-agent", ""))
    try:
        paired = access.pair(body.token, name, body.role, request.page.clients.names)
    except OverflowError as error:
        return ErrorResponse(409, str(error))
    if paired is None:
        return ErrorResponse(
            403, "this token is not good, or it was used, or it is too old; get a new one"
        )
    session, secret = paired
    request.cookie = cookie(request.scope, secret)
    return _me(request, session)


def get_me(request: ApiRequest) -> types.Me:
    """Return your own session."""
    return _me(request, request.caller)


def leave(request: ApiRequest) -> None:
    """End your own session."""
    request.page.access.sessions.revoke(request.caller.id)


def list_sessions(request: ApiRequest) -> list[types.SessionInfo] | ErrorResponse:
    """List the sessions: all of them on the computer that runs this, else yours and your tokens."""
    now = asyncio.get_running_loop().time()
    return [
        types.SessionInfo(
            session.id,
            session.name,
            session.role,
            "script" if session.kind is SessionKind.SCRIPT else "browser",
            now - session.seen,
            session is request.session,
        )
        for session in request.page.access.sessions.listed()
        if _may_manage(request.caller, session)
    ]


def revoke_session(request: ApiRequest) -> ErrorResponse | None:
    """End a session, and those of its tokens; the robots that they drive stop."""
    sessions = request.page.access.sessions
    number = request.path["session"]
    named = [s for s in sessions.listed() if s.id == number and _may_manage(request.caller, s)]
    if not named:
        return ErrorResponse(404, f"there is no session {number[:20]} that you may revoke")
    sessions.revoke(number)
    return None


def invite(request: ApiRequest, body: types.InvitationRequest) -> types.Invitation | ErrorResponse:
    """Make a one-time address that lets another device in."""
    access = request.page.access
    if request.caller.kind is not SessionKind.HERE:
        return ErrorResponse(403, NOT_HERE)
    if not access.urls:
        return ErrorResponse(409, "nobody else can reach this: start it with --lan")
    url = pairing_url(access.urls[0], access.invitations.invite(body.role), body.role)
    return types.Invitation(url, svg(url), body.role, TERM)


def create_token(request: ApiRequest, body: types.TokenRequest) -> types.Token | ErrorResponse:
    """Make a bearer token for a script. It ends with your session, or when it is revoked."""
    if request.caller.kind is SessionKind.SCRIPT:
        return ErrorResponse(403, "scripts make no tokens; ask on the page")
    parent = "" if request.caller.kind is SessionKind.HERE else request.caller.id
    try:
        session, secret = request.page.access.sessions.open(
            body.name, body.role, SessionKind.SCRIPT, parent
        )
    except OverflowError as error:
        return ErrorResponse(409, str(error))
    return types.Token(session.id, session.name, session.role, secret)


def _me(request: ApiRequest, session: LoginSession) -> types.Me:
    urls = request.page.access.urls
    return types.Me(session.id, session.name, session.role, session.kind is SessionKind.HERE, urls)


def _may_manage(caller: LoginSession, session: LoginSession) -> bool:
    return caller.kind is SessionKind.HERE or caller.id in {session.id, session.parent}


VIEWER: Literal[Role.VIEWER] = Role.VIEWER
DRIVER: Literal[Role.DRIVER] = Role.DRIVER
ACCESS = (
    operation("POST", "/api/pair", pair, None, 403, 409),
    operation("GET", "/api/me", get_me, VIEWER),
    operation("DELETE", "/api/me", leave, VIEWER),
    operation("GET", "/api/sessions", list_sessions, DRIVER),
    operation("DELETE", "/api/sessions/{session}", revoke_session, DRIVER, 404),
    operation("POST", "/api/invitations", invite, DRIVER, 409),
    operation("POST", "/api/tokens", create_token, DRIVER, 409),
)
