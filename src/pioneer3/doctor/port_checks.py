"""Findings about the connection: the port, the adapter, the device that answers."""

from collections.abc import Iterator
from functools import partial
from typing import Final

from pioneer3.doctor.facts import FORBIDDEN, UNREACHABLE, Finding, LinkFacts, failure, ok, warning
from pioneer3.doctor.ports import PortHolder, SerialPort, latency_file
from pioneer3.doctor.recognition import DeviceKind, OtherDevice
from pioneer3.errors import (
    PortBusyError,
    PortNotFoundError,
    PortPermissionError,
    Symptom,
    UnknownHostError,
)
from pioneer3.links.serial import SPEEDS, how_to_get_permission
from pioneer3.robot.supervisor import kind

LONGEST_LATENCY_MS: Final = 1
_closed = partial(failure, check="port", symptom=Symptom.NO_PORT)
_no_answer = partial(failure, check="answer", code=UNREACHABLE, symptom=Symptom.NO_ANSWER)


def check_port(facts: LinkFacts) -> Iterator[Finding]:
    """Does the link open? The last finding is a failure if it does not."""
    if facts.port is not None:
        yield from _serial_port(facts.port, facts)
        return
    if facts.refused is None:
        yield ok("port", f"{facts.url} opens")
        return
    yield _closed(
        found=str(facts.refused).removeprefix(f"{facts.url}: "),
        meaning="No connection at all: the robot's protocol has not been tried.",
        advice=_network_advice(facts),
        code=UNREACHABLE,
        symptom=Symptom.NO_ANSWER,
    )


def _network_advice(facts: LinkFacts) -> str:
    if isinstance(facts.refused, UnknownHostError):
        return "Check the spelling, or give the address in numbers: tcp://192.168.1.32:8101."
    if isinstance(facts.refused, PortNotFoundError):
        return (
            "Start the simulator (p3 sim) or the program on the robot's computer; for a robot on "
            "a cable give its port: p3 find-port lists them."
        )
    return "Check that the robot's computer is on and in this network: ping it."


def _serial_port(port: SerialPort, facts: LinkFacts) -> Iterator[Finding]:
    where = port.path if port.path == port.device else f"{port.path} ({port.device})"
    if port.holders:
        yield _busy(port.holders, where)
    elif isinstance(facts.refused, PortNotFoundError):
        yield _closed(
            found=f"{port.path} does not exist",
            meaning="The cable or its USB adapter is not plugged in, or has another name now.",
            advice="Plug it in, then run: p3 find-port",
            code=UNREACHABLE,
        )
    elif isinstance(facts.refused, PortPermissionError) or not port.allowed:
        command = how_to_get_permission(port.device)
        yield _closed(
            found=f"{where} exists, but this user may not open it",
            meaning="Serial ports belong to a group of users, and you are not in it (yet).",
            advice=f"{command[:1].upper()}{command[1:]} (a new terminal is not enough).",
            code=FORBIDDEN,
        )
    elif isinstance(facts.refused, PortBusyError):
        yield _busy((), where)
    elif facts.refused is not None:
        yield _closed(
            found=str(facts.refused),
            advice="Choose another port: p3 find-port lists them.",
            code=UNREACHABLE,
        )
    elif port.console:
        yield warning(
            check="port",
            found=f"{where} opens, but is the console of this computer",
            meaning="The kernel writes its messages to whatever is connected there.",
            advice="Take console=... for this port off the kernel's command line.",
            symptom=Symptom.NO_PORT,
        )
    else:
        yield ok("port", f"{where} opens")


def _busy(holders: tuple[PortHolder, ...], where: str) -> Finding:
    who = ", ".join(f"{holder.name} (process {holder.pid})" for holder in holders)
    return _closed(
        found=f"{where} is in use by {who or 'another program'}",
        meaning="Two programs on one port each get half of the robot's bytes.",
        advice=_how_to_free(holders, where),
    )


def _how_to_free(holders: tuple[PortHolder, ...], where: str) -> str:
    names = {holder.name for holder in holders}
    if "ModemManager" in names:
        return "It looks for modems. Run: sudo systemctl disable --now ModemManager"
    if any("getty" in name for name in names):
        tty = where.rpartition("/")[2].rstrip(")")
        return f"It offers a login there. Run: sudo systemctl disable --now serial-getty@{tty}"
    if not holders:
        return f"Find it with: sudo fuser -v {where.partition(' ')[0]}"
    return f"Quit it, or run: kill {' '.join(str(holder.pid) for holder in holders)}"


def check_adapter(facts: LinkFacts) -> Iterator[Finding]:
    """Does the USB adapter pass bytes on at once?"""
    port = facts.port
    if port is None or port.chip is None or facts.refused is not None:
        return
    if port.latency_ms is None or port.latency_ms <= LONGEST_LATENCY_MS:
        yield ok("adapter", f"{port.chip}: nothing to set")
        return
    yield warning(
        check="adapter",
        found=f"{port.chip} holds bytes back for up to {port.latency_ms} ms (latency timer)",
        meaning="All reports of the robot arrive late and in bursts.",
        advice=f"Until it is unplugged: echo 1 | sudo tee {latency_file(port.device)}",
        symptom=Symptom.LOSES_THE_LINK,
    )


def check_answer(facts: LinkFacts) -> Iterator[Finding]:
    """Does a robot answer?"""
    if facts.refused is not None or (facts.port and facts.port.holders):
        return
    if facts.info is not None:
        who = facts.info
        yield ok(
            "answer", f"{kind(who)} {who.identity.name}, {who.model.title} ({who.identity.model})"
        )
    elif facts.other_device is not None:
        yield _about(facts.other_device, facts)
    elif facts.closed:
        yield _hung_up(facts)
    else:
        yield _silence(facts)


def _hung_up(facts: LinkFacts) -> Finding:
    if facts.is_serial:
        return _no_answer(
            found="the port failed while it was in use",
            meaning="The adapter was unplugged, or lost its power.",
            advice="Plug it in again, straight into the computer, then run: p3 find-port",
        )
    return _no_answer(
        found="the other end hangs up without a word",
        meaning="Most likely it serves another program: a robot or simulator has one host.",
        advice="Quit the other program, or wait 2 s if it has crashed, then try again.",
    )


def _silence(facts: LinkFacts) -> Finding:
    if facts.is_serial:
        speeds = ", ".join(map(str, SPEEDS))
        return _no_answer(
            found=f"nothing answers at {speeds} baud",
            meaning="The robot is off, or the cable leads elsewhere.",
            advice="In this order: is the robot on (LED lit)? Is the cable in the socket marked "
            "HOST, and nothing in the other one? Is it a straight cable, no null modem? "
            "Press reset on the robot. Another port? p3 find-port",
        )
    return _no_answer(
        found="the connection opens, but nothing answers",
        meaning="Some other program listens there, or a serial bridge whose robot is off.",
        advice="Check the port number (simulators: 8101) and that the robot is on.",
    )


def _about(other_device: OtherDevice, facts: LinkFacts) -> Finding:
    if facts.streaming:
        return _no_answer(
            found=f"a robot that sends, but does not receive: {other_device.name}",
            meaning="Its reports of an earlier session arrive; nothing that is sent to it does.",
            advice="Look at the cable: one of its lines is broken, or it is meant for something "
            "else. Press reset on the robot.",
        )
    meaning, advice = _OTHER_DEVICES[other_device.kind]
    at = f" (at {', '.join(map(str, facts.heard_at))} baud)" if facts.heard_at else ""
    return _no_answer(found=f"{_named(other_device)}{at}", meaning=meaning, advice=advice)


def _named(other_device: OtherDevice) -> str:
    match other_device.kind:
        case DeviceKind.LASER:
            return f"not a robot but a laser: {other_device.name}"
        case DeviceKind.ECHO:
            return "not a robot but an echo of our own bytes"
        case DeviceKind.PACKETS:
            return f"no handshake, but {other_device.name}"
        case DeviceKind.TEXT:
            return f"not a robot but {other_device.name}"
        case DeviceKind.NOISE:
            return f"not a robot but bytes that make no sense: {other_device.name}"


_OTHER_DEVICES: Final = {
    DeviceKind.LASER: (
        "This port is the laser's; the robot is on another one. They swap numbers when unplugged.",
        "Give this one with --laser. The robot's: p3 find-port; names that stay: p3 setup udev.",
    ),
    DeviceKind.ECHO: (
        "Sent and received lines are joined: a loopback plug, a loose cable end, a modem.",
        "Connect the cable to the robot's HOST socket.",
    ),
    DeviceKind.PACKETS: (
        "It speaks the robot's protocol, but does not finish the handshake. A simulator such as "
        "AMRISim does so when an earlier program began with something else.",
        "Quit all other programs and try again: a new connection begins anew. If that does not "
        "help, start the simulator again, or press reset on the robot.",
    ),
    DeviceKind.TEXT: (
        "A device or program for people or others listens there.",
        "Choose another port: p3 find-port lists them.",
    ),
    DeviceKind.NOISE: (
        "Another device; or a robot at a speed that is not one of its own; or a broken cable.",
        "Switch the robot off and on (it returns to its first speed), then try again.",
    ),
}
