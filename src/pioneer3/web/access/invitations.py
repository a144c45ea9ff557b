"""One-time tokens that let another device in, and the addresses and QR codes that carry them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO, StringIO

from pioneer3.web.access.sessions import Role, fingerprint, new_secret

TERM = 600.0
"""How long a token is good [s]."""
MOST = 100
"""Unused tokens; one more pushes out the oldest."""


@dataclass(frozen=True, slots=True)
class _Token:
    """The role that a token gives, until when [s, monotonic]."""

    role: Role
    until: float


class Invitations:
    """Makes tokens and accepts each once. `clock` returns the time [s, monotonic]."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._open: dict[bytes, _Token] = {}

    def invite(self, role: Role) -> str:
        """Return a new token, which is not kept."""
        self._forget_expired()
        while len(self._open) >= MOST:
            del self._open[next(iter(self._open))]
        token = new_secret()
        self._open[fingerprint(token)] = _Token(role, self._clock() + TERM)
        return token

    def redeem(self, token: str) -> Role | None:
        """Return the role that `token` is good for, once; `None` if it is none, used or expired."""
        self._forget_expired()
        known = self._open.pop(fingerprint(token), None)
        return known.role if known else None

    def _forget_expired(self) -> None:
        now = self._clock()
        self._open = {mark: known for mark, known in self._open.items() if now < known.until}


def pairing_url(base: str, token: str, role: Role) -> str:
    """Return the address of the pairing page. Browsers send no server the part after the `#`.

    A viewer's address says so, for the page to offer no more; the token alone decides.
    """
    return f"{base}/pair#{token}{'.viewer' if role is Role.VIEWER else ''}"


def terminal_lines(url: str) -> list[str]:
    """Return the QR code of `url` for a terminal, light on dark or dark on light."""
    import segno

    out = StringIO()
    segno.make(url, error="l", micro=False).terminal(out, compact=True, border=2)
    return out.getvalue().rstrip("\n").split("\n")


def svg(url: str) -> str:
    """Return the QR code of `url` as an SVG element, for a page."""
    import segno

    out = BytesIO()
    code = segno.make(url, error="m", micro=False)
    code.save(out, kind="svg", border=4, light="#ffffff", xmldecl=False, omitsize=True)
    return out.getvalue().decode()


def invitation_lines(base: str, invitations: Invitations) -> Iterator[str]:
    """Yield a QR code and two addresses under `base`, each good once: for a driver and a viewer."""
    driver, viewer = (
        pairing_url(base, invitations.invite(role), role) for role in (Role.DRIVER, Role.VIEWER)
    )
    yield from terminal_lines(driver)
    yield f"Scan this to drive, or open {driver}"
    yield f"To watch only: {viewer}"
    yield f"Each is good once, for {TERM / 60:.0f} minutes."
