"""Finds and reads the own file of a robot, by its name or serial number.

It is a model's file, with the robot's lasers and camera besides; where it has no number, that of
`like` counts, or else of the type that the robot says. ARIA's parameter file beside it may be as
short. The folder is `~/.config/pioneer3/robots`.
"""

import json
import os
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.models.aria import parse_aria
from pioneer3.models.catalog import parse_own, read_model_text
from pioneer3.models.model import OwnFile, OwnLaser, RobotModel
from pioneer3.names import printable
from pioneer3.tables import Source, table_of, written
from pioneer3.text import user_folder

TOML: Final = ".toml"
"""Ending of our files; they count before the others."""
ARIA: Final = ".p"
"""Ending of ARIA's parameter files."""
OPTION: Final = re.compile(r"--\w+:? ")
"""The option that the errors of the readers of ports and cameras begin with."""
LONGEST: Final = 255
"""Longest name of a file [bytes]."""
CAMERA_EXAMPLE: Final = '# camera = "http://192.168.0.30:8080/stream"'
"""Line of a new file for a robot without a camera."""
ODOMETRY_EXAMPLE: Final = """\
# [odometry]                  # as measured; the driver corrects it
# scale = 1.0                 # true way over measured way
# base_ratio = 1.0            # measured turn over true turn, at scale 1
# wheel_ratio = 1.0           # right wheel's diameter over the left one's
"""
"""Lines of a new file for a robot that was not calibrated."""
LASER_EXAMPLE: Final = """\
# [[lasers]]
# port = "/dev/ttyACM0"
# kind = "urg-04lx"
# x = 0.16
# y = 0.0
# theta_deg = 0
"""
"""Lines of a new file for a robot without a laser."""


def own_folder() -> Path:
    """Return the folder of the robots' own files."""
    return user_folder("XDG_CONFIG_HOME", ".config") / "robots"


def own_path(name: str, ending: str = TOML) -> Path | None:
    """Return the path of the file of a robot of this name; `None` if no file can have it."""
    name = name.strip()
    fit = name.isprintable() and name and not name.startswith(".") and "/" not in name
    file = f"{name}{ending}"
    return own_folder() / file if fit and len(os.fsencode(file)) <= LONGEST else None


def find_own(names: Sequence[str], kin: RobotModel | None) -> OwnFile | None:
    """Return the own file of a robot, or `None` if none has its name or its serial number.

    `kin` is the model of the type that it says, if that is known.

    Raises:
        ConfigError: The file cannot be read, or is wrong.
    """
    path = path_of(names)
    return read_own(path, kin) if path else None


def path_of(names: Sequence[str]) -> Path | None:
    """Return the path of the first own file that there is by one of these names."""
    paths = (own_path(name, ending) for name in names for ending in (TOML, ARIA))
    return next((path for path in paths if path and _is_there(path)), None)


def _is_there(path: Path) -> bool:
    """Return whether there is such a file, even one that cannot be read."""
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        raise ConfigError(f"{printable(str(path))}: cannot be read: {error.strerror}") from None
    return True


def read_own(path: Path, kin: RobotModel | None = None) -> OwnFile:
    """Read the own file of a robot; ConfigError if it cannot be read, or is wrong."""
    text = read_model_text(path)
    if path.suffix == ARIA:
        model = parse_aria(text, str(path), path.stem, kin)
        return OwnFile(model=model, path=path)
    return replace(parse_own(text, str(path), kin), path=path)


def wrong_in_own(own: OwnFile, place: str, error: ConfigError) -> ConfigError:
    """Return the error about the key at `place`, made of that about an option."""
    said = OPTION.sub("", str(error), count=1)
    return Source.of(own.path, read_model_text(own.path)).wrong(place, said)


def new_own_text(name: str, model: str, lasers: Sequence[OwnLaser], camera: str | None) -> str:
    """Return the text of a new own file, with examples of what else may stand in it."""
    mounted = ({"port": each.port, **table_of(each.mount)} for each in lasers)
    tables = written({"lasers": list(mounted)}) if lasers else LASER_EXAMPLE
    told = f"camera = {json.dumps(camera)}" if camera else CAMERA_EXAMPLE
    return f"""\
# The own file of the robot {printable(name)}: its numbers count in place of its type's.
like = "{model}"

# max_speed = 0.7             # [m/s], never exceeded
# max_turn_rate_deg = 100     # [deg/s], never exceeded
{told}

{ODOMETRY_EXAMPLE}
{tables}"""


def own_files() -> tuple[Path, ...]:
    """Return the paths of all own files, sorted."""
    endings = (own_folder().glob(f"*{ending}") for ending in (TOML, ARIA))
    return tuple(sorted(path for paths in endings for path in paths))
