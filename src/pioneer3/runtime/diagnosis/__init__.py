"""Finds and explains what is wrong between this computer and a robot.

:func:`gather` collects :class:`Facts`, :func:`diagnose` draws the findings from them.
"""

from collections.abc import Iterable
from typing import Final

from pioneer3.runtime.diagnosis.facts import (
    FAILED,
    FORBIDDEN,
    UNREACHABLE,
    Facts,
    Finding,
    Heard,
    Level,
)
from pioneer3.runtime.diagnosis.gather import gather
from pioneer3.runtime.diagnosis.port_checks import check_adapter, check_answer, check_port
from pioneer3.runtime.diagnosis.robot_checks import (
    check_checksums,
    check_config,
    check_reports,
    check_session,
    check_speed,
    check_state,
)

__all__ = [
    "FAILED",
    "FORBIDDEN",
    "UNREACHABLE",
    "Facts",
    "Finding",
    "Heard",
    "Level",
    "diagnose",
    "exit_code",
    "gather",
]

CHECKS: Final = (
    check_port,
    check_adapter,
    check_answer,
    check_speed,
    check_session,
    check_config,
    check_reports,
    check_checksums,
    check_state,
)
"""From the plug to the wheels: what comes first must be mended first."""


def diagnose(facts: Facts) -> tuple[Finding, ...]:
    """Return the findings in the order in which they should be mended."""
    return tuple(finding for check in CHECKS for finding in check(facts))


def exit_code(findings: Iterable[Finding]) -> int:
    """Return 0 unless something failed, else the code of the first failure."""
    return next((f.code for f in findings if f.level is Level.FAIL), 0)
