"""Every signal to leave passes the `finally` blocks of a command."""

import asyncio
import os
import signal

import pytest

from pioneer3.cli.process import run_until_told_to_leave
from pioneer3.runtime.signals import LEAVE

pytestmark = pytest.mark.realtime


@pytest.mark.parametrize(("result", "code"), [(None, 0), (0, 0), (1, 1)])
def test_the_result_is_the_exit_code(result: int | None, code: int) -> None:
    async def command() -> int | None:
        return result

    assert run_until_told_to_leave(command()) == code


@pytest.mark.parametrize("number", LEAVE)
def test_a_signal_passes_the_finally_blocks(number: signal.Signals) -> None:
    passed = []

    async def command() -> None:
        try:
            os.kill(os.getpid(), number)
            await asyncio.sleep(10)
        finally:
            await asyncio.sleep(0)  # there is time to say goodbye
            passed.append(number)

    assert run_until_told_to_leave(command()) == 128 + number
    assert passed == [number]


def test_the_first_of_two_signals_is_told() -> None:
    async def command() -> None:
        try:
            os.kill(os.getpid(), signal.SIGTERM)
            await asyncio.sleep(10)
        finally:
            os.kill(os.getpid(), signal.SIGINT)
            await asyncio.sleep(10)

    assert run_until_told_to_leave(command()) == 143


def test_an_error_on_the_way_out_is_not_hidden() -> None:
    async def command() -> None:
        try:
            os.kill(os.getpid(), signal.SIGTERM)
            await asyncio.sleep(10)
        finally:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        run_until_told_to_leave(command())


def test_a_command_that_is_cancelled_without_a_signal_says_so() -> None:
    async def command() -> None:
        raise asyncio.CancelledError

    with pytest.raises(asyncio.CancelledError):
        run_until_told_to_leave(command())


def test_the_handlers_are_put_back() -> None:
    before = [signal.getsignal(n) for n in LEAVE]

    async def command() -> None:
        assert signal.getsignal(signal.SIGTERM) is not before[1]

    run_until_told_to_leave(command())
    assert [signal.getsignal(n) for n in LEAVE] == before


def test_a_hang_up_that_is_ignored_stays_ignored() -> None:
    async def command() -> int:
        os.kill(os.getpid(), signal.SIGHUP)
        await asyncio.sleep(0.1)
        return 7

    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert run_until_told_to_leave(command()) == 7
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)
