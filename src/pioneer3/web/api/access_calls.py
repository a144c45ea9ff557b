"""What the API does about who is in."""

import asyncio
from typing import Literal

from starlette.datastructures import Headers

from pioneer3.web.access.access import device
from pioneer3.web.access.gate import cookie
from pioneer3.web.access.invitations import TERM
from pioneer3.web.access.role import Role
from pioneer3.web.access.sessions import Kind, Session
from pioneer3.web.api import types
from pioneer3.web.api.operation import Call, operation
from pioneer3.web.problem import Problem

NOT_HERE = "only on the computer that runs this, at its own address http://127.0.0.1"


def pair(call: Call, body: types.Pairing) -> types.Me | Problem:
    """Come in with a one-time token; the answer sets a cookie."""
    access = call.page.access
    wait = access.throttle.wait(call.address)
    if wait:
        return Problem(429, f"too many attempts; try again in {wait:.0f} s")
    name = body.name or device(Headers(raw=call.scope["headers"]).get("user-agent", ""))
    try:
        others = [client.name for client in call.page.clients.connected.values()]
        paired = access.pair(body.token, name, body.role, others)
    except OverflowError as error:
        return Problem(409, str(error))
    if paired is None:
        return Problem(
            403, "this token is not good, or it was used, or it is too old; get a new one"
        )
    session, secret = paired
    call.cookie = cookie(call.scope, secret)
    return _me(call, session)


def get_me(call: Call) -> types.Me:
    """Say who you are here."""
    return _me(call, call.who)


def leave(call: Call) -> None:
    """End your own session."""
    call.page.access.sessions.revoke(call.who.id)


def list_sessions(call: Call) -> list[types.SessionInfo] | Problem:
    """List who is in: all of them on the computer that runs this, else yours and your tokens."""
    now = asyncio.get_running_loop().time()
    return [
        types.SessionInfo(
            session.id,
            session.name,
            session.role,
            "script" if session.kind is Kind.SCRIPT else "browser",
            now - session.seen,
            session is call.session,
        )
        for session in call.page.access.sessions.listed()
        if _is_theirs(call.who, session)
    ]


def revoke_session(call: Call) -> Problem | None:
    """Show somebody out, and the scripts whose tokens they made; what they drive stops."""
    sessions = call.page.access.sessions
    number = call.path["session"]
    named = [s for s in sessions.listed() if s.id == number and _is_theirs(call.who, s)]
    if not named:
        return Problem(404, f"there is no session {number[:20]} that you may revoke")
    sessions.revoke(number)
    return None


def invite(call: Call, body: types.Invite) -> types.Invitation | Problem:
    """Make a one-time address that lets somebody else in."""
    access = call.page.access
    if call.who.kind is not Kind.HERE:
        return Problem(403, NOT_HERE)
    if not access.urls:
        return Problem(409, "nobody else can reach this: start it with --lan")
    from pioneer3.web.access.invite import pairing_url, svg  # noqa: PLC0415

    url = pairing_url(access.urls[0], access.invitations.invite(body.role), body.role)
    return types.Invitation(url, svg(url), body.role, TERM)


def create_token(call: Call, body: types.TokenWish) -> types.Token | Problem:
    """Make a bearer token for a script. It ends with your session, or when it is revoked."""
    if call.who.kind is Kind.SCRIPT:
        return Problem(403, "scripts make no tokens; ask on the page")
    parent = "" if call.who.kind is Kind.HERE else call.who.id
    try:
        session, secret = call.page.access.sessions.open(body.name, body.role, Kind.SCRIPT, parent)
    except OverflowError as error:
        return Problem(409, str(error))
    return types.Token(session.id, session.name, session.role, secret)


def _me(call: Call, who: Session) -> types.Me:
    urls = call.page.access.urls
    return types.Me(who.id, who.name, who.role, who.kind is Kind.HERE, urls)


def _is_theirs(who: Session, session: Session) -> bool:
    return who.kind is Kind.HERE or who.id in {session.id, session.parent}


LOOK: Literal[Role.VIEWER] = Role.VIEWER
DO: Literal[Role.DRIVER] = Role.DRIVER
ACCESS = (
    operation("POST", "/api/pair", pair, None, 403, 409),
    operation("GET", "/api/me", get_me, LOOK),
    operation("DELETE", "/api/me", leave, LOOK),
    operation("GET", "/api/sessions", list_sessions, DO),
    operation("DELETE", "/api/sessions/{session}", revoke_session, DO, 404),
    operation("POST", "/api/invitations", invite, DO, 409),
    operation("POST", "/api/tokens", create_token, DO, 409),
)
