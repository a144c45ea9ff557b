"""Messages as bytes in bags, with the definitions that bags hold of them."""

from collections.abc import Callable
from typing import Any, Final

from pioneer3.ros.ros2.cdr import encoder
from pioneer3.ros.ros2.distros import DEFAULT, distro_of
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.tcpros.types import Ros1Types

HEADER: Final = "std_msgs/msg/Header"
"""The type that has a number in ROS 1 alone."""
NUMBER: Final = "seq"
"""Field of that number."""


class _Unnumbered(Ros1Types):
    """Types of ROS 1 as CDR has them: rosbags itself puts the number of a header in."""

    def __init__(self) -> None:
        super().__init__()
        constants, fields = self._store.fielddefs[HEADER]
        self._store.fielddefs[HEADER] = constants, [each for each in fields if each[0] != NUMBER]

    def from_cdr(self, cdr: bytes, name: str) -> bytes:
        """Return the serialized form in ROS 1 of a message in CDR."""
        return bytes(self._store.cdr_to_ros1(cdr, name))


class Ros1BagTypes(Ros1Types):
    """Messages of ROS 1; their headers have no number."""

    def __init__(self) -> None:
        super().__init__()
        self._unnumbered = _Unnumbered()
        self._encoders: dict[str, Callable[[Any], bytes]] = {}

    def encode(self, message: Any) -> bytes:
        """Return the serialized form; lists of numbers may stand for arrays."""
        name = message.__msgtype__
        if name not in self._encoders:
            self._encoders[name] = encoder(name, self._unnumbered.fields)
        return self._unnumbered.from_cdr(self._encoders[name](message), name)

    def described(self, name: str) -> tuple[str, str]:
        """Return the text of a type, with the types in it, and its checksum."""
        found = self.definition(name)
        return found.text, found.md5sum


class Ros2BagTypes(MessageTypes):
    """Messages of ROS 2."""

    def __init__(self) -> None:
        super().__init__(distro_of(DEFAULT))

    def described(self, name: str) -> tuple[str, str]:
        """Return the text of a type, with the types in it, and its hash."""
        return self.text(name), self.message_type(name).hash


BagTypes = Ros1BagTypes | Ros2BagTypes
