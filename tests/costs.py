"""The costs of tests: the slowest files and the processor time of each tier, after a run."""

import os
from collections import defaultdict
from collections.abc import Generator
from dataclasses import dataclass

import pytest

from tests.tiers import tier_of

SHOWN = 10
"""Files that are listed."""
TIME = "time [s]"
PROCESSOR = "processor time [s]"
TIER = "tier"


def processor_time() -> float:
    """Return what this process and its children that have ended have taken [s]."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


@dataclass
class Cost:
    """The cost of some tests.

    Attributes:
        tests: Their number.
        time: Wall-clock time, of each in its own process [s].
        processor: Processor time, without that of processes that outlive a test [s].
    """

    tests: int = 0
    time: float = 0.0
    processor: float = 0.0


class Costs:
    """A plugin that measures each test, and sums up where reports are collected."""

    def __init__(self) -> None:
        self._time, self._last = 0.0, processor_time()
        self._files: dict[str, Cost] = defaultdict(Cost)
        self._tiers: dict[str, Cost] = defaultdict(Cost)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Give the last report of a test its times and its tier."""
        report = yield
        self._time += report.duration
        if report.when == "teardown":
            now = processor_time()
            told = {TIME: self._time, PROCESSOR: now - self._last, TIER: tier_of(item)}
            report.user_properties += told.items()
            self._time, self._last = 0.0, now
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Add a test, maybe of another process."""
        if report.when != "teardown":
            return
        told = {name: str(value) for name, value in report.user_properties}
        for cost in (self._files[report.nodeid.partition("::")[0]], self._tiers[told[TIER]]):
            cost.tests += 1
            cost.time += float(told[TIME])
            cost.processor += float(told[PROCESSOR])

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Print the table after a run of many files."""
        if len(self._files) <= SHOWN:
            return
        write = terminalreporter.write_line
        write(f"\n{'the slowest files':60} {'time [s]':>9} {'processor [s]':>14}")
        slowest = sorted(self._files.items(), key=lambda each: -each[1].time)[:SHOWN]
        for name, cost in (*slowest, *sorted(self._tiers.items())):
            title = f"all {cost.tests} tests of the {name} tier" if name in self._tiers else name
            write(f"{title:60} {cost.time:9.1f} {cost.processor:14.1f}")
