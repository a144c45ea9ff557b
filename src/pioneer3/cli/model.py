"""`pioneer3 model`: the numbers of a robot's body, and its description for other programs."""

from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, Parameter

from pioneer3.cli.options import Flag, Json
from pioneer3.cli.process import write_json, write_line
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from rich.table import Table

    from pioneer3.models import RobotModel
    from pioneer3.models.numbers import Number

model_app = App(
    name="model",
    help="""List robot types; show a body in numbers, or write it for simulators and RViz.

    Example: pioneer3 model list
    Example: pioneer3 model show p3at-sh
    Example: pioneer3 model export p3at-sh --format mjcf
    """,
)
Format = Literal["urdf", "sdf", "mjcf", "bridge"]


@model_app.command(name="list")
def list_models(*, json: Json = False) -> int:
    """List the robot types that are known by name.

    Example: pioneer3 model list
    """
    from rich.table import Table

    from pioneer3.cli.terminal import Terminal
    from pioneer3.models import load_model, model_names

    models = [load_model(name) for name in model_names()]
    if json:
        write_json([{"name": model.name, "title": model.title} for model in models], indent=2)
        return 0
    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0), header_style="bold")
    for heading in ("name", "robot", "size [m]", "m/s", "sonars", "laser"):
        table.add_column(heading, no_wrap=True)
    for model in models:
        size = f"{model.length:.2f} x {model.width:.2f}"
        laser = model.laser.kind if model.laser else ""
        numbers = (f"{model.max_speed:g}", str(len(model.sonars)))
        table.add_row(model.name, model.title, size, *numbers, laser)
    Terminal().print(table)
    return 0


@model_app.command
def show(name: str, *, json: Json = False) -> int:
    """Show sizes, masses, motors and tires, with their units and sources.

    Example: pioneer3 model show p3dx-sh

    Args:
        name: One of `pioneer3 model list`, or a .toml or ARIA .p file.
    """
    from pioneer3.cli.terminal import Terminal
    from pioneer3.models import load_model
    from pioneer3.models.numbers import numbers_of

    model = load_model(name)
    numbers = numbers_of(model, shipped=not Path(name).suffix)
    if json:
        write_json([number._asdict() for number in numbers], indent=2)
    else:
        Terminal().print(_table(model, numbers))
    return 0


@model_app.command
def export(
    name: str,
    *,
    format_: Annotated[Format, Parameter(name="--format")] = "urdf",
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], metavar="FILE")] = None,
    force: Flag = False,
) -> int:
    """Write a robot's body: links, joints, inertias, shapes and sensors.

    urdf for ROS; sdf for Gazebo with wheels that drive and sensors, and bridge,
    the topics of ros_gz_bridge; mjcf for MuJoCo with motors, tires and a floor.

    Example: pioneer3 model export p3dx-sh --format mjcf

    Args:
        name: One of `pioneer3 model list`, or a .toml or ARIA .p file.
        format_: Of the description.
        output: The new file; without it, the terminal.
        force: Write over a file that is there.
    """
    from pioneer3.models import load_model
    from pioneer3.text import shown, write_bytes

    text = _described(load_model(name), format_)
    if output is None:
        write_line(text.rstrip("\n"))
        return 0
    if output.exists() and not force:
        raise ConfigError(f"{shown(str(output))}: is there already; --force writes over it")
    write_bytes(output, text.encode())
    write_line(f"wrote {output}")
    return 0


def _described(model: "RobotModel", format_: Format) -> str:
    from pioneer3.models.description.gazebo import bridge_of
    from pioneer3.models.description.mjcf import mjcf_of
    from pioneer3.models.description.sdf import sdf_of
    from pioneer3.models.description.tree import Frames, body_tree
    from pioneer3.models.description.urdf import describe

    match format_:
        case "urdf":
            frames = Frames()
            return describe(model, body_tree(model, frames), frames)
        case "sdf":
            return sdf_of(model)
        case "mjcf":
            return mjcf_of(model, floor=True)
        case "bridge":
            return bridge_of(model)


def _table(model: "RobotModel", numbers: "tuple[Number, ...]") -> "Table":
    from rich.table import Table
    from rich.text import Text

    table = Table(
        box=None, pad_edge=False, header_style="bold", title=Text(f"{model.title} ({model.name})")
    )
    table.add_column("number", no_wrap=True)
    table.add_column("value", justify="right")
    table.add_column("unit", no_wrap=True)
    table.add_column("source", style="dim", overflow="fold")
    for part, members in groupby(numbers, key=lambda number: number.part):
        table.add_row(Text(part, "bold"))
        for _, name, value, unit, source in members:
            table.add_row(f" {name}", value, unit, Text(source))
    return table
