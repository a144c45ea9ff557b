"""Addresses that let a phone in, as text and as QR codes."""

from io import BytesIO, StringIO

import segno

from pioneer3.web.access.role import Role


def pairing_url(base: str, token: str, role: Role) -> str:
    """Return the address of the pairing page. No server ever sees what stands after the `#`.

    A viewer's says so, for the page to offer no more; the token alone decides.
    """
    return f"{base}/pair#{token}{'.viewer' if role is Role.VIEWER else ''}"


def terminal_lines(url: str) -> list[str]:
    """Return the QR code of `url` for a terminal, light on dark or dark on light."""
    out = StringIO()
    segno.make(url, error="l", micro=False).terminal(out, compact=True, border=2)
    return out.getvalue().rstrip("\n").split("\n")


def svg(url: str) -> str:
    """Return the QR code of `url` as an SVG element, for a page."""
    out = BytesIO()
    code = segno.make(url, error="m", micro=False)
    code.save(out, kind="svg", border=4, light="#ffffff", xmldecl=False, omitsize=True)
    return out.getvalue().decode()
