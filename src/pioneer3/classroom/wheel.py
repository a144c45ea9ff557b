"""Makes the wheel of this package as it runs here, for those who have none."""

import hashlib
from base64 import urlsafe_b64encode
from pathlib import Path
from typing import Final
from zipfile import ZIP_DEFLATED, ZipFile

from pioneer3.distribution import NAME, own_files, own_metadata, version

TAG: Final = "py3-none-any"
"""Any Python 3, on any computer: nothing in it is compiled."""
WHEEL: Final = f"Wheel-Version: 1.0\nGenerator: {NAME}\nRoot-Is-Purelib: true\nTag: {TAG}\n"
"""Content of the file WHEEL, as the format asks for it."""


def build_wheel(folder: Path) -> Path:
    """Write the wheel into a folder; return its path."""
    release = f"{NAME}-{version()}"
    path = folder / f"{release}-{TAG}.whl"
    record = f"{release}.dist-info/RECORD"
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        rows = []

        def add(name: str, data: bytes) -> None:
            archive.writestr(name, data)
            digest = urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            rows.append(f"{name},sha256={digest},{len(data)}\n")

        for name, source in own_files():
            add(name, source.read_bytes())
        for name, text in (*own_metadata(), ("WHEEL", WHEEL)):
            add(f"{release}.dist-info/{name}", text.encode())
        archive.writestr(record, f"{''.join(rows)}{record},,\n")
    return path
