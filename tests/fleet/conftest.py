"""A lab for the tests that want one."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fleet.lab import Lab, why_not


@pytest.fixture(scope="session")
def possible() -> None:
    """Skip where there are no namespaces or no sshd."""
    if reason := why_not():
        pytest.skip(reason)


@pytest.fixture
def lab(possible: None, tmp_path: Path) -> Iterator[Lab]:
    """An operator and three robots that know each other."""
    with Lab(tmp_path) as lab:
        yield lab


@pytest.fixture
def new_lab(possible: None, tmp_path: Path) -> Iterator[Lab]:
    """An operator without a key and three robots, as on the first day."""
    with Lab(tmp_path, introduced=False) as lab:
        yield lab
