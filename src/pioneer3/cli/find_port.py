"""`p3 find-port`: which port is the robot's?"""

import sys
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.connection import Json

if TYPE_CHECKING:
    from pioneer3.runtime.ports import SerialPort
    from pioneer3.runtime.probe import Probed

NOT_FOUND = 3

Flag = Annotated[bool, Parameter(negative=())]


def find_port(*, no_probe: Flag = False, wait: Flag = False, json: Json = False) -> int:
    """List the ports of this computer and say which one is the robot's.

    Ports that nobody uses are asked politely; nothing moves, nothing is changed. Ends with 3 when
    there is no robot. Example: `p3 find-port`

    Args:
        no_probe: Only list the ports, send nothing.
        wait: Find the port by unplugging the robot's cable and plugging it in again.
        json: Print JSON for programs, nothing else.
    """
    import asyncio  # noqa: PLC0415

    from pioneer3.runtime.ports import list_ports  # noqa: PLC0415
    from pioneer3.runtime.probe import choose  # noqa: PLC0415

    if wait:
        ports = _replugged()
        urls: list[str] = []
    else:
        from pioneer3.runtime.probe import SIMULATOR_URL  # noqa: PLC0415

        ports, urls = list_ports(), [SIMULATOR_URL]
    found = _listed(ports, urls) if no_probe else asyncio.run(_probed(ports, urls))
    if json:
        _print_json(found)
    else:
        _show(found, probed=not no_probe)
    if no_probe:
        return 0 if found else NOT_FOUND
    return 0 if choose(found) else NOT_FOUND


def _listed(ports: "tuple[SerialPort, ...]", urls: list[str]) -> "list[Probed]":
    from pioneer3.runtime.probe import Probed, Verdict, prejudge  # noqa: PLC0415

    listed = [prejudge(port) or Probed(port.path, Verdict.NOT_PROBED, "", port) for port in ports]
    return listed + [Probed(url, Verdict.NOT_PROBED) for url in urls]


async def _probed(ports: "tuple[SerialPort, ...]", urls: list[str]) -> "list[Probed]":
    from pioneer3.cli.output import busy_sign  # noqa: PLC0415
    from pioneer3.runtime.probe import probe, probe_port  # noqa: PLC0415

    found = []
    for port in ports:
        with busy_sign(f"Asking {port.path} ..."):
            found.append(await probe_port(port))
    for url in urls:
        with busy_sign(f"Asking {url} ..."):
            found.append(await probe(url))
    return found


def _replugged() -> "tuple[SerialPort, ...]":
    """Lead a person through unplugging and plugging in; return the ports that came back."""
    import asyncio  # noqa: PLC0415

    from pioneer3.cli.output import busy_sign  # noqa: PLC0415
    from pioneer3.runtime.ports import list_ports  # noqa: PLC0415
    from pioneer3.runtime.probe import wait_for_plug  # noqa: PLC0415

    before = list_ports()
    sys.stderr.write("Unplug the robot's cable from this computer, then press Enter. ")
    sys.stderr.flush()
    sys.stdin.readline()
    without = list_ports()
    sys.stderr.write("Now plug it in again.\n")
    with busy_sign("Waiting for it ..."):
        return asyncio.run(wait_for_plug(before, without, list_ports))


def _print_json(found: "list[Probed]") -> None:
    from pioneer3.cli.output import write_json  # noqa: PLC0415
    from pioneer3.runtime.probe import choose  # noqa: PLC0415

    best = choose(found)
    ports = [
        {
            "url": each.url,
            "verdict": each.verdict,
            "detail": each.detail,
            "port": each.port,
            "identity": each.info.identity if each.info else None,
        }
        for each in found
    ]
    write_json({"use": best.url if best else None, "ports": ports}, indent=2)


def _show(found: "list[Probed]", *, probed: bool) -> None:
    from rich.console import Console  # noqa: PLC0415

    from pioneer3.cli.tables import advice, ports_table  # noqa: PLC0415

    console = Console(highlight=False)
    if found:
        console.print(ports_table(found))
    if probed or not found:
        console.print(advice(found), soft_wrap=True)
