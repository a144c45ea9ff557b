"""An error in the driver of a laser is a loss of the laser, and of nothing else."""

import asyncio

import pytest

from pioneer3.links import Link
from pioneer3.robot.lasers.driver import LaserConfig, LaserDriver
from pioneer3.robot.supervisor import Connection
from pioneer3.tasks import running


async def test_an_error_of_its_own_is_told_and_it_tries_again(
    caplog: pytest.LogCaptureFixture,
) -> None:
    attempts = 0

    async def broken() -> Link:
        nonlocal attempts
        attempts += 1
        raise ValueError("no such thing")

    driver = LaserDriver(LaserConfig(url="memory:laser", open=broken))
    told = set()
    async with running(driver.run()):
        async with asyncio.timeout(10):
            async for status in driver.status.values():
                told.add(status.message)
                if attempts == 3 and status.connection is Connection.LOST:
                    break
    assert "memory:laser: failed: ValueError('no such thing')" in told
    assert "memory:laser failed" in caplog.text
