"""`pioneer3 robot`: the own file of a robot, found by its name or serial number."""

import os
import shlex
from contextlib import suppress
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated, Final

from cyclopts import App, Parameter

from pioneer3.cli.options import LINK, Flag, LinkOptions
from pioneer3.cli.process import run_until_told_to_leave, write_line
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from pioneer3.models import RobotModel

KIN: Final = "what differs from the type that the robot says"
"""The model in an own file that is not `like` another."""

Name = Annotated[str, Parameter(allow_leading_hyphen=True)]
"""The name of a robot, even one such as `-rb`."""

robot_app = App(
    name="robot",
    help="""Show, make and edit a robot's own file: model, limits, lasers, camera.

    Every command that connects finds it by the name that the robot says, or its
    serial number, in ~/.config/pioneer3/robots: NAME.toml, or ARIA's NAME.p.

    Example: pioneer3 robot init --port /dev/ttyUSB0
    """,
)


@robot_app.command
def show(name: Name | None = None) -> int:
    """Show the own file of a robot; without a name, list the files that there are.

    Example: pioneer3 robot show rosie

    Args:
        name: That the robot says, or its serial number.
    """
    from pioneer3.models.catalog import read_model_text
    from pioneer3.models.own import ARIA, own_files, own_folder

    if name is None:
        paths = own_files()
        told = f"no robot has a file of its own in {own_folder()}: pioneer3 robot init"
        write_line("\n".join(map(str, paths)) or told)
        return 0
    path = _path(name)
    model = _checked(path)
    told = f"{model.title} ({model.name}), at most {model.max_speed:g} m/s" if model else KIN
    if (hidden := path.with_name(f"{path.stem}{ARIA}")) != path and hidden.exists():
        told += f"; {hidden.name} beside it is not read"
    write_line(f"# {path}: {told}")
    write_line(read_model_text(path).rstrip())
    return 0


@robot_app.command
def init(name: str | None = None, *, link: LinkOptions = LINK, force: Flag = False) -> int:
    """Make the own file of a robot, with what it says and the options tell.

    With NAME and --model no robot is asked; else the one at --port says both.

    Example: pioneer3 robot init --port /dev/ttyUSB0 --laser urg-04lx@/dev/ttyACM0
    Example: pioneer3 robot init rosie --model p3at-sh

    Args:
        name: That the robot says; else the robot is asked.
        force: Write over a file that is there.
    """
    return run_until_told_to_leave(_init(name, link, force=force))


async def _init(name: str | None, link: LinkOptions, *, force: bool) -> int:
    from pioneer3.models import load_model
    from pioneer3.models.own import ARIA, TOML, new_own_text, own_folder, own_path, path_of
    from pioneer3.robot.lasers.spec import own_laser
    from pioneer3.text import shown, write_bytes

    model = link.model
    if name is None or model is None:
        async with link.connect(auto_enable=False) as robot:
            name = name or robot.info.identity.name
            model = model or robot.info.identity.model
    path = own_path(name)
    if path is None:
        raise ConfigError(f"{shown(name)}: no name of a file; give one: pioneer3 robot init NAME")
    there = path_of((name,))
    if there and not force:
        raise ConfigError(f"{there}: is there already; edit it, or --force writes {path.name}")
    if Path(model).suffix.lower() in (ARIA, TOML):
        raise ConfigError(f"{shown(model)}: copy it to {own_folder()} by the robot's name: it does")
    kin = load_model(model)
    specs = zip(link.lasers.laser, await link.lasers.specs(), strict=True)
    lasers = [own_laser(text, spec, kin) for text, spec in specs]
    text = new_own_text(name, model, lasers, link.camera)
    with suppress(OSError):  # the file cannot be written then, and that tells why
        path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes(path, text.encode())
    write_line(f"wrote {path}; pioneer3 robot edit {quote(name)}")
    return 0


@robot_app.command
def edit(name: Name) -> int:
    """Open the own file of a robot in $VISUAL or $EDITOR, and check it.

    Example: pioneer3 robot edit rosie

    Args:
        name: That the robot says, or its serial number.
    """
    import subprocess

    path = _path(name)
    editors = (os.environ.get(each, "").strip() for each in ("VISUAL", "EDITOR"))
    editor = next(filter(None, editors), None)
    if editor is None:
        raise ConfigError(f"no editor is named: set EDITOR, or open {path}")
    try:
        subprocess.run([*shlex.split(editor), str(path)], check=True)
    except (OSError, ValueError, subprocess.CalledProcessError) as error:
        raise ConfigError(f"{editor}: {error}") from None
    _checked(path)
    write_line(f"{path}: is right, and counts from the next connection on")
    return 0


def _checked(path: Path) -> "RobotModel | None":
    """Return the model of an own file; `None` if it has only what differs from the robot's type."""
    from pioneer3.models import load_model
    from pioneer3.models.own import read_own
    from pioneer3.runtime.connect import USUAL, fitted_by

    try:
        own = read_own(path)
        model: RobotModel | None = own.model
    except ConfigError:
        own, model = read_own(path, load_model(USUAL)), None
    fitted_by(own)
    return model


def _path(name: str) -> Path:
    """Return the path of the own file of a robot."""
    from pioneer3.models.own import own_folder, path_of

    path = path_of((name,))
    if path is None:
        raise ConfigError(f"no file {name}.toml or {name}.p in {own_folder()}: pioneer3 robot init")
    return path
