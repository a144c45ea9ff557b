"""`p3 doctor`: what is wrong, what it means, what to do."""

from typing import TYPE_CHECKING

from pioneer3.cli.connection import DEFAULT_PORT, Baud, Json, Port

if TYPE_CHECKING:
    from pioneer3.runtime.diagnosis import Finding


def doctor(
    *, port: Port = DEFAULT_PORT, baud: Baud = None, seconds: float = 3.0, json: Json = False
) -> int:
    """Check the way to the robot from the plug to the wheels, and say what to do.

    Nothing moves and the motors stay off. Ends with 0 unless a check failed, then with 3 (robot not
    reachable), 4 (no permission) or 1. Example: `p3 doctor -p /dev/ttyUSB0`

    Args:
        port: Where the robot is: /dev/ttyUSB0, tcp://localhost:8101.
        baud: Serial speed to try first.
        seconds: How long to listen to the robot [s].
        json: Print JSON for programs, nothing else.
    """
    import asyncio  # noqa: PLC0415

    from pioneer3.cli.output import busy_sign, write_json  # noqa: PLC0415
    from pioneer3.runtime.diagnosis import diagnose, exit_code, gather  # noqa: PLC0415

    with busy_sign(f"Asking {port} and listening for {seconds:g} s ..."):
        findings = diagnose(asyncio.run(gather(port, baud=baud, seconds=seconds)))
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
