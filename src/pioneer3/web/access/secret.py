"""Secrets that are handed out once; only their fingerprints are kept."""

from hashlib import sha256
from secrets import token_urlsafe

BYTES = 32
"""Entropy of a secret: 256 bits, where 128 would do."""
LONGEST = 128
"""No secret of ours has more characters."""


def new_secret() -> str:
    """Return a secret for a URL, a cookie or a header."""
    return token_urlsafe(BYTES)


def fingerprint(secret: str) -> bytes:
    """Return what to keep of `secret`.

    Looking that up leaks nothing by its timing: who guesses does not choose the fingerprint.
    """
    return sha256(secret[: LONGEST + 1].encode("utf-8", "replace")).digest()
