"""The robot's configuration, asked for anew (facts.md 8.15)."""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import groupby

from pioneer3.arcos.reports import Config
from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Mode
from pioneer3.errors import PioneerError
from pioneer3.models import RobotModel
from pioneer3.robot.config_table import explained


def config(cockpit: Cockpit) -> Mode:
    """Return the mode that reports the configuration."""
    lines: tuple[str, ...] = ()

    async def ask() -> None:
        nonlocal lines
        lines = ("asking the robot for its CONFIG ...",)
        try:
            answer = await cockpit.robot.devices.configuration()
        except PioneerError as error:
            lines = (str(error),)
            return
        lines = (*config_lines(answer), "", *model_lines(cockpit.robot.info.model))

    @contextmanager
    def enter() -> Iterator[None]:
        cockpit.work(ask())
        yield

    return Mode(
        key="o",
        name="report robot config",
        label="config",
        help=(
            "o: ask again",
            "up, down: scroll",
        ),
        enter=enter,
        again=lambda: cockpit.work(ask()),
        details=lambda: lines,
    )


def config_lines(answer: Config) -> Iterator[str]:
    """Yield every field by group: its name, its value, its unit, its meaning."""
    for group, rows in groupby(explained(answer), key=lambda row: row.group):
        yield f"{group}:"
        for row in rows:
            yield f"  {row.field:25} {f'{row.value} {row.unit}'.rstrip():>12}  {row.meaning}"


def model_lines(model: RobotModel) -> Iterator[str]:
    """Yield what no CONFIG tells, but the model does."""
    yield f"of the model {model.name}:"
    yield f"front bumpers  {model.front_bumpers or 'none'}"
    yield f"rear bumpers   {model.rear_bumpers or 'none'}"
    yield f"table sensing  {len(model.table_irs) or 'none'}"
    yield f"sonars         {len(model.sonars)}"
    yield f"laser          {model.laser.kind if model.laser else 'none'}"
    yield (
        f"size           length {model.length:.3f} m, width {model.width:.3f} m,"
        f" radius {model.radius:.3f} m"
    )
