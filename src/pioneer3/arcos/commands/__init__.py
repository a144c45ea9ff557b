"""Everything a host can tell a robot (arcos.md 3), each command a frozen dataclass in SI units.

A class has the ARCOS name in CamelCase (`VEL` is :class:`Vel`) and its number as `ID`. Where a
report has the same name, the command is called `Request...` (`CONFIG` is :class:`RequestConfig`).

=============  =====================================================================
module         what for
=============  =====================================================================
session        beginning, keeping and ending a session
motion         driving
tuning         limits, accelerations, controller gains, calibration
sensors        sonar, gyro, compass, bumpers, inputs and outputs
accessories    gripper, sounds, pan-tilt unit, auxiliary serial ports
arm            the five-axis arm
power          batteries, power switches, safety
service        diagnosis, maintenance, faked readings
simulator      what only simulators understand
srisim         old simulator commands with the numbers of other commands
choices        the enumerations among the arguments
=============  =====================================================================
"""

from importlib import import_module
from typing import TYPE_CHECKING

from pioneer3.arcos.commands.codec import (
    MODULES,
    Command,
    Unknown,
    every_command,
    from_payload,
    to_payload,
)

# The 138 classes take longer to create than all the rest of the driver, and a host needs a dozen:
# a module is imported when one of its names is first asked for. Each module's own __all__ is the
# one list of its names; repeating them here would be a second.
# ruff: noqa: F403
if TYPE_CHECKING:
    from pioneer3.arcos.commands import (
        accessories,
        arm,
        choices,
        motion,
        power,
        sensors,
        service,
        session,
        simulator,
        srisim,
        tuning,
    )
    from pioneer3.arcos.commands.accessories import *
    from pioneer3.arcos.commands.arm import *
    from pioneer3.arcos.commands.choices import *
    from pioneer3.arcos.commands.motion import *
    from pioneer3.arcos.commands.power import *
    from pioneer3.arcos.commands.sensors import *
    from pioneer3.arcos.commands.service import *
    from pioneer3.arcos.commands.session import *
    from pioneer3.arcos.commands.simulator import *
    from pioneer3.arcos.commands.srisim import *
    from pioneer3.arcos.commands.tuning import *

    __all__ = ["Command", "Unknown", "every_command", "from_payload", "to_payload"]
    __all__ += accessories.__all__
    __all__ += arm.__all__
    __all__ += choices.__all__
    __all__ += motion.__all__
    __all__ += power.__all__
    __all__ += sensors.__all__
    __all__ += service.__all__
    __all__ += session.__all__
    __all__ += simulator.__all__
    __all__ += srisim.__all__
    __all__ += tuning.__all__


def __getattr__(name: str) -> object:
    if name.startswith("_") and name != "__all__":
        raise AttributeError(name)
    homes = (import_module(f"{__name__}.{module}") for module in ("choices", *MODULES))
    if name == "__all__":
        own = ["Command", "Unknown", "every_command", "from_payload", "to_payload"]
        return own + [exported for home in homes for exported in home.__all__]
    for home in homes:
        if name in home.__all__:
            globals()[name] = value = getattr(home, name)
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
