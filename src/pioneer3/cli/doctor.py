"""`pioneer3 doctor`."""

from typing import TYPE_CHECKING

from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.options import DEFAULT_PORT, Baud, Flag, Port, Seconds

if TYPE_CHECKING:
    from pioneer3.doctor.facts import Finding


def doctor(
    *, port: Port = DEFAULT_PORT, baud: Baud = None, seconds: Seconds = 3.0, json: Flag = False
) -> int:
    """Check everything from the plug to the wheels; say what is wrong and what to do.

    Nothing moves, and the motors stay off. The exit code is 0 unless a check
    failed; then 3 (no robot can be reached), 4 (no permission) or 1.

    Example: pioneer3 doctor --port /dev/ttyUSB0

    Args:
        port: The robot: /dev/ttyUSB0, localhost:8101.
        baud: Serial speed to try first.
        seconds: How long to listen to the robot.
        json: Print JSON for programs, nothing else.
    """
    return run_until_told_to_leave(_doctor(port, baud, seconds, json=json))


async def _doctor(port: str, baud: int | None, seconds: float, *, json: bool) -> int:
    from pioneer3.cli.output import busy_sign, write_json  # noqa: PLC0415
    from pioneer3.doctor.diagnose import (  # noqa: PLC0415
        diagnose,
        exit_code,
        gather,
    )

    with busy_sign(f"Asking {port}, and listening for {seconds:g} s ..."):
        findings = diagnose(await gather(port, baud=baud, seconds=seconds))
    code = exit_code(findings)
    if json:
        write_json({"port": port, "exit_code": code, "findings": findings}, indent=2)
    else:
        _show(findings)
    return code


def _show(findings: "tuple[Finding, ...]") -> None:
    from rich.console import Console  # noqa: PLC0415

    from pioneer3.cli.tables import findings_table, verdict  # noqa: PLC0415

    console = Console(highlight=False)
    console.print(findings_table(findings))
    console.print(verdict(findings))
