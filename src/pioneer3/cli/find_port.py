"""`pioneer3 find-port`."""

import sys
from typing import TYPE_CHECKING

from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.options import Flag

if TYPE_CHECKING:
    from pioneer3.doctor.ports import SerialPort
    from pioneer3.doctor.probe import Probed


def find_port(*, no_probe: Flag = False, wait: Flag = False, json: Flag = False) -> int:
    """List the ports of this computer and say which one is the robot's.

    Ports that no other program uses are asked politely: nothing moves, nothing is
    set. The exit code is 3 when no robot was found.

    Example: pioneer3 find-port

    Args:
        no_probe: Only list the ports; send nothing.
        wait: Find the port by unplugging the robot's cable and plugging it in again.
        json: Print JSON for programs, nothing else.
    """
    return run_until_told_to_leave(_find_port(no_probe=no_probe, wait=wait, json=json))


async def _find_port(*, no_probe: bool, wait: bool, json: bool) -> int:
    from pioneer3.doctor.ports import list_ports  # noqa: PLC0415
    from pioneer3.doctor.probe import SIMULATOR_URL, found_code  # noqa: PLC0415

    ports = await _replugged() if wait else list_ports()
    urls = () if wait else (SIMULATOR_URL,)
    found = await _looked_at(ports, urls, no_probe=no_probe)
    if json:
        _print_json(found)
    else:
        _show(found, probed=not no_probe)
    return found_code(found)


async def _looked_at(
    ports: "tuple[SerialPort, ...]", urls: tuple[str, ...], *, no_probe: bool
) -> "list[Probed]":
    from pioneer3.cli.output import busy_sign  # noqa: PLC0415
    from pioneer3.doctor.probe import not_probed, probe, probe_port  # noqa: PLC0415

    if no_probe:
        return not_probed(ports, urls)
    found = []
    for port in ports:
        with busy_sign(f"Asking {port.path} ..."):
            found.append(await probe_port(port))
    for url in urls:
        with busy_sign(f"Asking {url} ..."):
            found.append(await probe(url))
    return found


async def _replugged() -> "tuple[SerialPort, ...]":
    """Lead a person through unplugging and plugging in; return the ports that came back."""
    from pioneer3.cli.output import busy_sign  # noqa: PLC0415
    from pioneer3.doctor.ports import list_ports  # noqa: PLC0415
    from pioneer3.doctor.probe import came_back, wait_for_plug  # noqa: PLC0415

    before = list_ports()
    _say("Unplug the robot's cable from this computer, then press Enter. ")
    await _enter_pressed()
    without = list_ports()
    if not came_back(before, without, before):
        _say("No port has vanished: was the cable in this computer?\n")
    _say("Now plug it in again.\n")
    with busy_sign("Waiting for it ..."):
        return await wait_for_plug(before, without, list_ports)


async def _enter_pressed() -> None:
    """Wait for a line on stdin; unlike a thread that reads, this can be interrupted."""
    import asyncio  # noqa: PLC0415

    loop, ready = asyncio.get_running_loop(), asyncio.Event()
    try:
        loop.add_reader(sys.stdin.fileno(), ready.set)
    except OSError:  # a file, which never makes anybody wait
        return
    try:
        await ready.wait()
    finally:
        loop.remove_reader(sys.stdin.fileno())
    sys.stdin.readline()


def _say(text: str) -> None:
    sys.stderr.write(text)
    sys.stderr.flush()


def _print_json(found: "list[Probed]") -> None:
    from pioneer3.cli.output import write_json  # noqa: PLC0415
    from pioneer3.doctor.probe import choose  # noqa: PLC0415

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
    if probed:
        console.print(advice(found), soft_wrap=True)
