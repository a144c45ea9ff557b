"""`pioneer3 info`, `doctor` and `find-port`."""

from math import pi
from typing import TYPE_CHECKING

from pioneer3.cli.options import LINK, WHICH, Baud, Flag, Json, LinkOptions, RobotOptions, Seconds
from pioneer3.cli.process import busy_sign, read_line, until_told_to_leave, write_error, write_json
from pioneer3.errors import MotionError

COURSE = 1.0
"""How far `doctor --drive` drives, there and back [m]."""

if TYPE_CHECKING:
    from pioneer3.doctor.facts import Finding
    from pioneer3.doctor.ports import SerialPort
    from pioneer3.doctor.probe import Probed
    from pioneer3.links import Opener
    from pioneer3.models import GivenModel
    from pioneer3.runtime.robot import Robot


@until_told_to_leave
async def info(*, link: LinkOptions = LINK, json: Json = False) -> int:
    """Show who the robot is, its limits and its battery.

    Nothing moves.

    Example: pioneer3 info --port /dev/ttyUSB0
    """
    async with link.connect(auto_enable=False, shown=True) as robot:
        if json:
            write_json(_as_data(robot), indent=2)
        else:
            _show_robot(robot)
    return 0


def _show_robot(robot: "Robot") -> None:
    from pioneer3.cli.tables import robot_tables
    from pioneer3.cli.terminal import Terminal

    console = Terminal()
    for table in robot_tables(robot.info, robot.snapshot):
        console.print(table)


def _as_data(robot: "Robot") -> dict[str, object]:
    from pioneer3.robot.supervisor import kind

    info, snapshot = robot.info, robot.snapshot
    return {
        "kind": kind(info),
        "url": info.url,
        "speed": info.speed,
        "identity": info.identity,
        "model": info.model,
        "limits": info.limits,
        "battery": snapshot.battery if snapshot else None,
        "config": info.config,
    }


@until_told_to_leave
async def doctor(
    *,
    which: RobotOptions = WHICH,
    baud: Baud = None,
    seconds: Seconds = 3.0,
    drive: Flag = False,
    json: Json = False,
) -> int:
    """Check everything from the plug to the wheels; say what is wrong and what to do.

    Nothing moves, and the motors stay off. With --drive the robot MOVES at last, if
    all else is well: a metre there and back, with two half turns. A simulated twin
    tells whether its wheels do what they should. Any key stops it, k is the
    emergency stop. Variables of ROS 1 are checked, too, if they are set. The exit
    code is 0 unless a check failed; then 3 (no robot can be reached), 4 (no
    permission) or 1.

    Example: pioneer3 doctor --port /dev/ttyUSB0

    Args:
        seconds: How long to listen to the robot.
        drive: Drive a metre, too: do its wheels do what they are told?
    """
    import asyncio

    from pioneer3.doctor.diagnose import diagnose, exit_code, gather
    from pioneer3.ros.ros1.environment import check_environment

    port = which.url
    with busy_sign(f"Asking {port}, and listening for {seconds:g} s ..."):
        facts = await gather(port, baud=baud, model=which.given_model, seconds=seconds)
        findings = (*diagnose(facts), *await asyncio.to_thread(lambda: [*check_environment()]))
    if drive and not exit_code(findings):
        findings = (*findings, await _driven(port, which.given_model, baud, json=json))
    code = exit_code(findings)
    if json:
        write_json({"port": port, "exit_code": code, "findings": findings}, indent=2)
    else:
        _show_findings(findings)
    return code


async def _driven(
    port: "str | Opener", model: "GivenModel", baud: int | None, *, json: bool
) -> "Finding":
    """Drive a short course beside a simulated twin; return the finding about it."""
    import asyncio

    from pioneer3.calibration.course import CourseLeg, drive, ground_of
    from pioneer3.cli.live import announce, how_to_stop, show_while
    from pioneer3.doctor.robot_checks import drive_finding
    from pioneer3.runtime.connect import connect_robot
    from pioneer3.runtime.shadow import STALL
    from pioneer3.tasks import running

    legs = [CourseLeg(way=COURSE), CourseLeg(turn=pi), CourseLeg(way=COURSE), CourseLeg(turn=-pi)]
    told = None
    async with connect_robot(port, baud=baud, model=model, shadow=True) as robot:
        announce(robot, f"drives {COURSE:g} m and back; {how_to_stop()}", json=json)

        async def watch() -> None:
            nonlocal told
            async for _ in robot.snapshots():
                parting = robot.shadow and robot.shadow.parting
                told = told or (parting.text if parting else None)

        held_up = None

        async def go() -> None:
            await drive(robot, legs, ground_of(robot.info.model, COURSE))

        async with running(watch()):
            try:
                await show_while(robot, go())
            except MotionError as error:
                held_up = str(error)
                await asyncio.sleep(STALL)  # a stall is told once the robot stands
    return drive_finding(told, held_up)


def _show_findings(findings: "tuple[Finding, ...]") -> None:
    from pioneer3.cli.tables import findings_table, verdict
    from pioneer3.cli.terminal import Terminal

    console = Terminal()
    console.print(findings_table(findings))
    console.print(verdict(findings))


@until_told_to_leave
async def find_port(*, no_probe: Flag = False, wait: Flag = False, json: Json = False) -> int:
    """List the ports of this computer and say which one is the robot's.

    Ports that no other program uses are asked politely: nothing moves, nothing is
    set. The exit code is 3 when no robot was found.

    Example: pioneer3 find-port

    Args:
        no_probe: Only list the ports; send nothing.
        wait: Find the port by unplugging the robot's cable and plugging it in again.
    """
    from pioneer3.doctor.ports import list_ports
    from pioneer3.doctor.probe import SIMULATOR_URL, found_code

    ports = await _replugged() if wait else list_ports()
    urls = () if wait else (SIMULATOR_URL,)
    found = await _looked_at(ports, urls, no_probe=no_probe)
    if json:
        _print_json(found)
    else:
        _show_ports(found, probed=not no_probe)
    return found_code(found)


async def _looked_at(
    ports: "tuple[SerialPort, ...]", urls: tuple[str, ...], *, no_probe: bool
) -> "list[Probed]":
    from pioneer3.doctor.probe import not_probed, probe_all

    if no_probe:
        return not_probed(ports, urls)
    with busy_sign("Asking all ports ...") as show:
        return await probe_all(
            ports, urls, lambda waiting: show(f"Asking {', '.join(waiting)} ...")
        )


async def _replugged() -> "tuple[SerialPort, ...]":
    """Lead a person through unplugging and plugging in; return the ports that came back."""
    from pioneer3.doctor.ports import list_ports
    from pioneer3.doctor.probe import came_back, wait_for_plug

    before = list_ports()
    write_error("Unplug the robot's cable from this computer, then press Enter. ", end="")
    await read_line()
    without = list_ports()
    if not came_back(before, without, before):
        write_error("No port has vanished: was the cable in this computer?")
    write_error("Now plug it in again.")
    with busy_sign("Waiting for it ..."):
        return await wait_for_plug(before, without, list_ports)


def _print_json(found: "list[Probed]") -> None:
    from pioneer3.doctor.probe import choose

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


def _show_ports(found: "list[Probed]", *, probed: bool) -> None:
    from pioneer3.cli.tables import advice, ports_table
    from pioneer3.cli.terminal import Terminal

    console = Terminal()
    if found:
        console.print(ports_table(found))
    if probed:
        console.print(advice(found), soft_wrap=True)
