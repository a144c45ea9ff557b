"""Commands that measure, as a simulated laser reads them (scip.md 2.1, 2.3). No I/O."""

from dataclasses import dataclass

from pioneer3.lasers.scip.scans import FORMATS
from pioneer3.models.lasers import Steps


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanRequest:
    """Scans that a host wants; `text` is the whole command with its comment, for the echo.

    So many neighbouring steps become one reading, `cluster`; so many scans are left out after each
    one, `skip`; `scans` of 0 have no end.
    """

    letters: str
    text: str
    start: int
    end: int
    cluster: int
    skip: int = 0
    scans: int = 0


def read_request(command: str, text: str, steps: Steps) -> ScanRequest | str:
    """Return the scans that `command` asks for in SCIP 2.0, or the status for wrong parameters.

    Its letters, as in MD0044072501000, are known; `text` is the same with its comment.
    """
    letters = command[:2]
    streamed = FORMATS[letters].streamed
    if len(command) != (15 if streamed else 12):
        return "0C"
    start, end, cluster = command[2:6], command[6:10], command[10:12]
    skip, scans = (command[12:13], command[13:15]) if streamed else ("0", "0")
    for status, digits in (
        ("01", start),
        ("02", end),
        ("03", cluster),
        ("06", skip),
        ("07", scans),
    ):
        if not (digits.isascii() and digits.isdecimal()):
            return status
    if int(end) > steps.last:
        return "04"
    if int(end) < int(start):
        return "05"
    return ScanRequest(
        letters=letters,
        text=text,
        start=int(start),
        end=int(end),
        cluster=max(int(cluster), 1),
        skip=int(skip),
        scans=int(scans),
    )


def read_scip1_request(text: str, steps: Steps) -> ScanRequest | None:
    """Return the scan that a G of SCIP 1.1 asks for, or `None` if its parameters are wrong."""
    digits = text[1:]
    if len(digits) != 8 or not (digits.isascii() and digits.isdecimal()):
        return None
    start, end, cluster = int(digits[:3]), int(digits[3:6]), int(digits[6:])
    if not start <= end <= 2 * steps.front:
        return None
    return ScanRequest(letters="G", text=text, start=start, end=end, cluster=max(cluster, 1))
