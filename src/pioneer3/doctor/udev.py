"""Rules for udev that give robots and lasers names that stay. Pure.

A rule names a device by the serial number of its USB adapter. Where that has none, which most
Prolific adapters and all Hokuyo lasers lack, a laser is asked for its own number when it is plugged
in, and an adapter is known by the socket that it sits in.
"""

import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from pioneer3.doctor.ports import SerialPort

FILE: Final = "/etc/udev/rules.d/70-pioneer3.rules"
GROUP: Final = "dialout"
FOLDER: Final = "pioneer3"
"""Names begin with this, below /dev."""
NOT_IN_NAMES: Final = re.compile(r"[^A-Za-z0-9_.-]+")


@dataclass(frozen=True, slots=True)
class UdevRule:
    """A line for udev; in `link`, a name below /dev, the program prints `$result` or `%c`."""

    about: str
    link: str
    text: str


def rules(ports: Sequence[SerialPort], program: str) -> tuple[UdevRule, ...]:
    """Return a rule for each USB serial port; Hokuyo lasers share one.

    `program` is the path of `pioneer3`, for lasers that must be asked.
    """
    found = [_rule(port, program) for port in ports if port.vendor_id is not None]
    return tuple(dict.fromkeys(found))


def written(found: Sequence[UdevRule]) -> str:
    """Return the text of the file."""
    lines = [
        "# Names that stay for the robots and lasers of this computer; written by:",
        "#     pioneer3 setup udev",
    ]
    for rule in found:
        lines += ["", f"# {rule.about}: /dev/{rule.link}", rule.text]
    return "\n".join(lines) + "\n"


def _rule(port: SerialPort, program: str) -> UdevRule:
    if port.is_hokuyo:
        return _asked(port, program)
    name = NOT_IN_NAMES.sub("-", port.serial_number)
    match = _usb(port)
    about = f"{port.chip}, serial number {port.serial_number}"
    if name:
        match += f', ATTRS{{serial}}=="{port.serial_number}"'
    else:
        name = NOT_IN_NAMES.sub("-", port.socket)
        match += f', ENV{{ID_PATH}}=="{port.socket}"'
        about = f"{port.chip} without a serial number, in the USB socket {port.socket}"
    link = f"{FOLDER}/serial-{name}"
    return UdevRule(about, link, f'{match}, GROUP="{GROUP}", MODE="0660", SYMLINK+="{link}"')


def _asked(port: SerialPort, program: str) -> UdevRule:
    ask = f"{shlex.quote(program)} laser id /dev/%k"
    text = (
        f'{_usb(port)}, GROUP="{GROUP}", MODE="0660", PROGRAM="{ask}", SYMLINK+="{FOLDER}/laser-%c"'
    )
    return UdevRule("Hokuyo lasers, by the number that each tells", f"{FOLDER}/laser-NUMBER", text)


def _usb(port: SerialPort) -> str:
    return (
        'ACTION=="add", SUBSYSTEM=="tty", '
        f'ATTRS{{idVendor}}=="{port.vendor_id:04x}", ATTRS{{idProduct}}=="{port.product_id:04x}"'
    )
