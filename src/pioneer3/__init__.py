"""Drive, simulate and program Pioneer 3 robots; a program begins with :func:`connect`."""

TYPE_CHECKING = False  # the module typing takes a while, in which Ctrl-C is not quiet yet

if TYPE_CHECKING:
    from pioneer3 import log
    from pioneer3.errors import (
        CommandError,
        ConfigError,
        DeviceError,
        LinkError,
        MotionError,
        NoRobotError,
        PioneerError,
        PortBusyError,
        PortNotFoundError,
        PortPermissionError,
    )
    from pioneer3.geometry import Pose2, Twist2
    from pioneer3.models import RobotModel, load_model
    from pioneer3.navigation.blocking import BlockingRobot
    from pioneer3.navigation.connect import connect, connect_async
    from pioneer3.runtime.blocking import BlockingLaser, connect_laser
    from pioneer3.runtime.connect import connect_laser_async
    from pioneer3.runtime.robot import Robot
    from pioneer3.state import Scan, Snapshot

_HOME = {
    "BlockingLaser": "runtime.blocking",
    "BlockingRobot": "navigation.blocking",
    "Pose2": "geometry",
    "Robot": "runtime.robot",
    "RobotModel": "models",
    "Scan": "state",
    "Snapshot": "state",
    "Twist2": "geometry",
    "connect": "navigation.connect",
    "connect_async": "navigation.connect",
    "connect_laser": "runtime.blocking",
    "connect_laser_async": "runtime.connect",
    "load_model": "models",
}
_MODULES = ("log",)
"""Public modules."""

__version__ = "0.2.0"
__all__ = [
    "BlockingLaser",
    "BlockingRobot",
    "CommandError",
    "ConfigError",
    "DeviceError",
    "LinkError",
    "MotionError",
    "NoRobotError",
    "PioneerError",
    "PortBusyError",
    "PortNotFoundError",
    "PortPermissionError",
    "Pose2",
    "Robot",
    "RobotModel",
    "Scan",
    "Snapshot",
    "Twist2",
    "connect",
    "connect_async",
    "connect_laser",
    "connect_laser_async",
    "load_model",
    "log",
]


def __getattr__(name: str) -> object:
    """Import public names when they are first used (PEP 562)."""
    from importlib import import_module

    if name not in __all__:
        raise AttributeError(f"module 'pioneer3' has no attribute {name!r}")
    if name in _MODULES:
        return import_module(f"pioneer3.{name}")
    return getattr(import_module(f"pioneer3.{_HOME.get(name, 'errors')}"), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
