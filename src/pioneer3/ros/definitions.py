"""Messages of packages that nobody need install: definitions, of which classes are made.

A definition is the text of a `.msg` file; types in it come behind a line, as in bags.
"""

from collections.abc import Mapping
from typing import Final

HEADER: Final = """================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
"""
BUMPER_TYPE: Final = "rosaria/BumperState"
DEFINITIONS: Final[Mapping[str, str]] = {
    BUMPER_TYPE: f"Header header\nbool[] front_bumpers\nbool[] rear_bumpers\n{HEADER}",
    "p2os_msgs/AIO": "uint8 voltages_count\nfloat32[] voltages\n",
    "p2os_msgs/BatteryState": f"Header header\nfloat32 voltage\n{HEADER}",
    "p2os_msgs/DIO": "uint32 count\nuint16 bits\n",
    "p2os_msgs/MotorState": "int32 state\n",
    "p2os_msgs/SonarArray": f"Header header\nint32 ranges_count\nfloat64[] ranges\n{HEADER}",
}
"""Definitions by type; checksums are those of the packages themselves."""
IMPORT: Final = "from genpy.dynamic import generate_dynamic\n\n"


def file_of(type_name: str) -> str:
    """Return the content of the `.msg` file of a type."""
    return DEFINITIONS[type_name].removesuffix(HEADER)


def module_of(package: str) -> str:
    """Return a Python module `msg` of a package: its classes, made when it is imported."""
    classes = (
        f"{kind.partition('/')[2]} = generate_dynamic({kind!r}, {text!r})[{kind!r}]\n"
        for kind, text in DEFINITIONS.items()
        if kind.startswith(f"{package}/")
    )
    return IMPORT + "".join(classes)
