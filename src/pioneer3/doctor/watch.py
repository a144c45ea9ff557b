"""Monitors the line to a connected robot with the checks of the diagnosis."""

from collections import deque
from collections.abc import Iterator
from itertools import pairwise

from pioneer3.arcos.reports import Report, Sip
from pioneer3.doctor.facts import Finding, Heard, LinkFacts
from pioneer3.doctor.ports import SerialPort
from pioneer3.doctor.robot_checks import battery_finding, check_checksums, check_reports
from pioneer3.robot.supervisor import Supervisor
from pioneer3.state import LinkQuality

WINDOW = 10.0
"""Length of the evaluated past [s]."""
LEAST = 2.0
"""Shortest past that is evaluated [s]."""
PATIENCE = 0.3
"""A report counts as missing when it is this late [s]."""


class LineWatch:
    """Counts reports and corrupt frames over the last :data:`WINDOW`."""

    def __init__(self, supervisor: Supervisor) -> None:
        self._supervisor = supervisor
        self._history: deque[tuple[float, LinkQuality]] = deque()
        supervisor.reports.hand_to(self._take, Sip)

    def findings(self, now: float) -> Iterator[Finding]:
        """Yield findings about the line and the battery at `now` [s, monotonic]."""
        info, snapshot = self._supervisor.info, self._supervisor.snapshot
        if info is None or snapshot is None:
            return
        yield battery_finding(snapshot, info)
        heard = self._summary(now)
        if heard is not None:
            facts = LinkFacts(url=info.url, port=_port(info.url), info=info, heard=heard)
            yield from check_reports(facts)
            yield from check_checksums(facts)

    def _summary(self, now: float) -> Heard | None:
        if not self._history:
            return None
        (began, before), (last, after) = self._history[0], self._history[-1]
        end = last if now - last < PATIENCE else now
        if end - began < LEAST:
            return None
        stamps = [*(stamp for stamp, _ in self._history), end]
        reports = len(self._history) - 1
        return Heard(
            seconds=end - began,
            reports=reports,
            longest_gap=max(later - earlier for earlier, later in pairwise(stamps)),
            packets=reports,
            bad_checksums=after.bad_checksums - before.bad_checksums,
            bytes_skipped=after.bytes_skipped - before.bytes_skipped,
        )

    def _take(self, report: Report, stamp: float) -> None:
        snapshot = self._supervisor.snapshot
        if snapshot is None:
            return
        if self._history and self._history[-1][1].sessions != snapshot.link.sessions:
            self._history.clear()
        self._history.append((stamp, snapshot.link))
        while stamp - self._history[0][0] > WINDOW:
            self._history.popleft()


def _port(url: str) -> SerialPort | None:
    """Return the serial port in `url`, with its name only; `None` for other links."""
    scheme, _, path = url.partition(":")
    return SerialPort(path=path, device=path) if scheme == "serial" else None
