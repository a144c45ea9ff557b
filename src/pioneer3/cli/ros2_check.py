"""`pioneer3 ros2 check`."""

from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.options import Json, Seconds
from pioneer3.cli.process import busy_sign, until_told_to_leave, write_json
from pioneer3.cli.ros2_network import ANYWHERE, NetworkOptions

if TYPE_CHECKING:
    from pioneer3.ros.checks.facts import CheckReport


@until_told_to_leave
async def check(
    *,
    robot: Annotated[str | None, Parameter(name=["--robot", "-r"])] = None,
    seconds: Seconds = 5.0,
    model: str | None = None,
    network: NetworkOptions = ANYWHERE,
    json: Json = False,
) -> int:
    """Check a robot's node, ours or anybody's: topics, services, transforms.

    It listens to all topics of the robot and compares them with the tables that
    pioneer3 docs ros2-node shows: types, quality of service, rates, stamps, frames,
    numbers. Nothing moves, and no service is called. With --ros-args come the
    remapping rules of the robot's node. The exit code is 1 if something is wrong,
    and 3 if there is no robot.

    Example: pioneer3 ros2 check
    Example: pioneer3 ros2 check --robot robot1 --seconds 10 --json

    Args:
        robot: Name of its node, or its namespace, if there are several.
        seconds: How long to listen.
        model: Type of the robot, such as p3at-sh: as many sonars are expected.
    """
    from pioneer3.doctor.facts import Level
    from pioneer3.ros.checks.listening import Question, check_robot

    node = network.node("check")
    question = Question(robot=robot, seconds=seconds, model=model)
    with busy_sign("Joining the network ...") as progress:
        report = await check_robot(node, question, progress)
    code = 1 if report.count(Level.FAIL) else 0
    if json:
        _write(report, code)
    else:
        _show(report)
    return code


def _write(report: "CheckReport", code: int) -> None:
    rows = [
        {
            "part": row.part,
            "name": row.name,
            "expected": row.expected,
            "found": row.found,
            "verdict": "absent" if row.absent else row.level,
            "rate": row.rate,
            "takes": row.absent,
            "faults": row.faults,
        }
        for row in report.rows
    ]
    write_json(
        {"node": report.node, "seconds": report.seconds, "exit_code": code, "rows": rows}, indent=2
    )


def _show(report: "CheckReport") -> None:
    from pioneer3.cli.ros2_check_table import absent_line, summary, table
    from pioneer3.cli.terminal import Terminal

    console = Terminal(wide=True)
    console.print(table(report, console.width))
    for line in (absent_line(report), summary(report)):
        if line is not None:
            console.print(line)
