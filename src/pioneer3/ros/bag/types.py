"""Messages as bytes in bags, with the definitions that bags hold of them."""

from pioneer3.ros.ros2.distros import DEFAULT, distro_of
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.tcpros.types import Ros1Types


class Ros1BagTypes(Ros1Types):
    """Messages of ROS 1."""

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
