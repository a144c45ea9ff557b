"""Tests file by file in several processes (`--workers`), which are forked when all are collected.

Collecting takes as long as a hundred tests that drive: it is done once, and not in each process.
"""

import multiprocessing as mp
import os
import signal
from collections.abc import Callable, Iterator
from itertools import chain, groupby
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

import pytest

NUMBER_BYTES = 2
"""Size of the number of a file in the queue; a pipe gives so little to one reader only [bytes]."""


class Workers:
    """A plugin that runs tests in processes, each of which takes the next file when it is free."""

    def __init__(self, number: int, begin: Callable[[], None]) -> None:
        """Make the plugin; each of `number` processes calls `begin` first."""
        self._number, self._begin = number, begin
        self._ended: set[str] = set()

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool | None:
        """Run all tests; what a process that died has left over has failed."""
        if session.testsfailed or session.config.option.collectonly:
            return None
        files = [list(tests) for _, tests in groupby(session.items, lambda item: item.path)]
        queue, queued = os.pipe()
        os.write(queued, b"".join(n.to_bytes(NUMBER_BYTES) for n in range(len(files))))
        os.close(queued)
        # made in this process, so that all folders are in one that is removed later
        folder = session.config._tmp_path_factory.getbasetemp()  # type: ignore[attr-defined]
        processes: dict[Connection, int] = {}
        try:
            for number in range(min(self._number, len(files))):
                reports, reported = mp.Pipe(duplex=False)
                process = os.fork()
                if not process:
                    for each in (reports, *processes):  # else nobody notices when this one ends
                        each.close()
                    self._work(session, folder / str(number), _taken(queue, files), reported)
                reported.close()
                processes[reports] = process
            self._collect(session, set(processes))
        finally:
            os.close(queue)
            for process in processes.values():
                _end(process)
        for item in session.items:
            if item.nodeid not in self._ended:
                self._fail(item)
        return True

    def _work(
        self,
        session: pytest.Session,
        folder: Path,
        items: Iterator[pytest.Item],
        reported: Connection,
    ) -> None:
        """Run tests in a process that was forked; it ends here."""
        status = 1
        try:
            config = session.config
            folder.mkdir()
            config._tmp_path_factory._basetemp = folder  # type: ignore[attr-defined]
            config.pluginmanager.unregister(name="terminalreporter")
            config.pluginmanager.register(_Reporter(config, reported))
            capture: Any = config.pluginmanager.getplugin("capturemanager")
            capture.stop_global_capturing()  # its files are those of the other processes too
            capture.start_global_capturing()
            capture.suspend_global_capture()
            self._begin()
            item = next(items, None)
            while item:
                following = next(items, None)
                config.hook.pytest_runtest_protocol(item=item, nextitem=following)
                item = following
            status = 0
        except KeyboardInterrupt:
            pass
        finally:
            session._setupstate.teardown_exact(None)
            os._exit(status)

    def _collect(self, session: pytest.Session, processes: set[Connection]) -> None:
        """Pass reports on until all processes have ended."""
        config = session.config
        while processes:
            for reports in wait(processes):
                assert isinstance(reports, Connection)
                try:
                    data = reports.recv()
                except EOFError:
                    processes.remove(reports)
                    continue
                report = config.hook.pytest_report_from_serializable(config=config, data=data)
                if report.when == "teardown":
                    self._ended.add(report.nodeid)
                config.hook.pytest_runtest_logreport(report=report)
                if session.shouldfail:
                    raise session.Failed(session.shouldfail)

    def _fail(self, item: pytest.Item) -> None:
        words = "its process died in this test, or before it"
        report = pytest.TestReport(item.nodeid, item.location, {}, "failed", words, "call")
        item.config.hook.pytest_runtest_logreport(report=report)


class _Reporter:
    """A plugin of a process that sends its reports."""

    def __init__(self, config: pytest.Config, reported: Connection) -> None:
        self._config, self._reported = config, reported

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        hook = self._config.hook
        self._reported.send(hook.pytest_report_to_serializable(config=self._config, report=report))


def _taken(queue: int, files: list[list[pytest.Item]]) -> Iterator[pytest.Item]:
    """Return the tests of one file after the other that no other process has taken."""
    numbers = iter(lambda: os.read(queue, NUMBER_BYTES), b"")
    return chain.from_iterable(files[int.from_bytes(number)] for number in numbers)


def _end(process: int) -> None:
    """Interrupt a process that still runs, which ends what its tests began, and wait for it."""
    os.kill(process, signal.SIGINT)
    os.waitpid(process, 0)
