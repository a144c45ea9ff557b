"""`pioneer3 config`: the settings of a robot's controller, and their backups."""

from dataclasses import asdict, replace
from time import time
from typing import TYPE_CHECKING, Annotated, Final

from cyclopts import App, Parameter

from pioneer3.cli.options import LINK, Flag, Json, LinkOptions
from pioneer3.cli.process import until_told_to_leave, write_json, write_line, write_warning
from pioneer3.errors import ConfigError, DeviceError, MotionError
from pioneer3.names import printable

if TYPE_CHECKING:
    from pioneer3.arcos.reports import Config
    from pioneer3.robot.config_backup import ConfigBackup
    from pioneer3.runtime.robot import Robot

MODEL: Final = "model"
"""Word for the defaults of the robot's model, in place of a backup."""
DIFFERS: Final = 1
"""Exit code of `diff` where something differs, as that of diff."""
Backup = Annotated[str | None, Parameter(metavar="BACKUP", show_default=False)]
"""Part of the name of a backup, of several the newest; or a file, with a slash in its name."""

config_app = App(
    name="config",
    help="""Show, back up, compare and restore the settings of a robot's controller.

    Backups are kept in ~/.local/state/pioneer3/config, by robot and time.
    BACKUP is a part of a name there, of several the newest, or a file such as
    ./rosie.toml.

    Example: pioneer3 config show --port /dev/ttyUSB0
    Example: pioneer3 config backup --port /dev/ttyUSB0
    """,
)


@config_app.command
@until_told_to_leave
async def show(*, link: LinkOptions = LINK, json: Json = False) -> int:
    """Show all settings, beside the defaults of the model and the last backup.

    They are those from before this command connected. Nothing moves.

    Example: pioneer3 config show --port /dev/ttyUSB0
    """
    from pioneer3.cli.tables import config_table
    from pioneer3.cli.terminal import Terminal
    from pioneer3.robot.config_backup import defaults_of, last_backup, with_defaults
    from pioneer3.robot.config_table import rows_by_field

    async with link.connect(auto_enable=False, shown=True) as robot:
        config, info = _config_of(robot), robot.info
    rows = rows_by_field(with_defaults(config, info.model))
    others = {MODEL: {field: rows[field] for field in defaults_of(info.model)}}
    if backup := last_backup(info):
        others[f"backup {backup.made[:10]}"] = rows_by_field(backup.config)
    if json:
        fields = rows_by_field(config).items()
        known = {field: {name: others[name].get(field) for name in others} for field, _ in fields}
        write_json({field: asdict(row) | known[field] for field, row in fields}, indent=2)
    else:
        Terminal().print(config_table(config, others, None))
    return 0


@config_app.command
@until_told_to_leave
async def backup(*, link: LinkOptions = LINK) -> int:
    """Keep all settings in a file. Nothing moves.

    Example: pioneer3 config backup --port /dev/ttyUSB0
    """
    from pioneer3.robot.config_backup import save_backup

    async with link.connect(auto_enable=False, shown=True) as robot:
        path = save_backup(robot.info, _config_of(robot), time())
    write_line(f"wrote {path}")
    return 0


@config_app.command(name="list")
def list_() -> int:
    """List the backups, the newest last.

    Example: pioneer3 config list
    """
    from pioneer3.robot.config_backup import backups_folder, read_backup, user_backups

    paths = user_backups()
    if not paths:
        write_line(f"No backups in {backups_folder()}: pioneer3 config backup")
    for path in paths:
        try:
            kept = read_backup(path)
        except ConfigError as error:
            write_warning(str(error))
            continue
        robot = f"{kept.name} ({kept.model}, serial number {kept.serial_number or 'none'})"
        write_line(f"{path.stem}  {printable(robot)}")
    return 0


@config_app.command
@until_told_to_leave
async def diff(
    first: Backup = None, second: Backup = None, *, link: LinkOptions = LINK, json: Json = False
) -> int:
    """Show the settings that differ from a backup, or from the defaults of the model.

    The robot is compared with its last backup, with FIRST, or with its model by
    the word model. With SECOND no robot is asked. The exit code is 1 if something
    differs, 0 if nothing does, more if they could not be compared.

    Example: pioneer3 config diff --port /dev/ttyUSB0
    Example: pioneer3 config diff model
    Example: pioneer3 config diff 2026-03-01 2026-11-27

    Args:
        first: To compare with; else the last backup of the robot.
        second: In place of the robot.
    """
    from pioneer3.cli.tables import config_table
    from pioneer3.cli.terminal import Terminal
    from pioneer3.models import load_model
    from pioneer3.robot.config_backup import differing, find_backup, with_defaults
    from pioneer3.robot.config_table import rows_by_field

    if second is not None:
        kept = find_backup(second)
        config, model = (
            kept.config,
            load_model(link.model or kept.model) if first == MODEL else None,
        )
    else:
        async with link.connect(auto_enable=False, shown=True) as robot:
            config, model = _config_of(robot), robot.info.model
    if first == MODEL:
        assert model is not None
        other = with_defaults(config, model)
    else:
        other = (find_backup(first) if first else _last(robot)).config
    fields = differing(config, other)
    rows = rows_by_field(config), rows_by_field(other)
    if json:
        found = {field: {"value": rows[0][field], "other": rows[1][field]} for field in rows[0]}
        write_json({field: row for field, row in found.items() if field in fields}, indent=2)
    elif fields:
        Terminal().print(config_table(config, {first or "backup": rows[1]}, fields))
    return DIFFERS if fields else 0


@config_app.command
@until_told_to_leave
async def restore(name: Backup = None, *, link: LinkOptions = LINK, force: Flag = False) -> int:
    """Set again what a backup has, as far as a host may, while the robot stands.

    It tells what the robot took, and what only its maker's tool writes. A
    controller keeps this until it is switched off at most. Programs that drive
    set top speeds and accelerations anew when they connect. TicksMM, RevCount and
    DriftFactor of the robot's own file count before those of the backup.

    Example: pioneer3 config restore --port /dev/ttyUSB0

    Args:
        name: The backup; else the last one of the robot.
        force: Take the backup of another robot.
    """
    from pioneer3.robot.config_backup import differing, find_backup, restoring, with_encoders
    from pioneer3.robot.config_table import rows_by_field
    from pioneer3.robot.pilot import stands
    from pioneer3.text import shown

    async with link.connect(auto_enable=False, shown=True) as robot:
        kept = find_backup(name) if name else _last(robot)
        if not (force or kept.is_of(robot.info)):
            of = f"{shown(kept.name)}, serial number {shown(kept.serial_number)}"
            raise ConfigError(f"the backup is of {of}, not of this robot; --force takes it")
        kept = replace(kept, config=with_encoders(kept.config, robot.info.model))
        present = await robot.devices.configuration()
        wanted = dict(restoring(kept.config, present, robot.info.model))
        if robot.supervisor.taken or robot.snapshot is None or not stands(robot.snapshot):
            raise MotionError("nothing is set while the robot moves or another program drives it")
        for command in wanted.values():
            robot.send(command)
        after = await robot.devices.configuration() if wanted else present
    left = differing(kept.config, after)
    names, is_, was = rows_by_field(kept.config), rows_by_field(after), rows_by_field(present)
    for field in names:
        words = f"{names[field].field}: {names[field].value} {names[field].unit}".rstrip()
        if field in wanted:
            told = (
                f"set, was {was[field].value}" if field not in left else "was sent, and not taken"
            )
            write_line(f"{words}: {told}")
        elif field in left:
            write_line(f"{words}: only the maker's tool writes it; it is {is_[field].value}")
    if wanted:
        write_line("A controller forgets this at the latest when it is switched off.")
    return DIFFERS if left else 0


def _config_of(robot: "Robot") -> "Config":
    """Return CONFIG as it was before this session set anything."""
    if robot.info.config is None:
        raise DeviceError("the robot did not send its configuration: older controllers have none")
    return robot.info.config


def _last(robot: "Robot") -> "ConfigBackup":
    from pioneer3.robot.config_backup import last_backup

    found = last_backup(robot.info)
    if found is None:
        raise ConfigError("this robot has no backup yet: pioneer3 config backup")
    return found
