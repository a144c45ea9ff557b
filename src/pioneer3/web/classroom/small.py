"""Small snapshots of a class's robots, for the teacher's page."""

from collections.abc import Callable
from typing import Literal

from pioneer3.geometry import Pose2
from pioneer3.web import messages
from pioneer3.web.control import Operator
from pioneer3.web.robot_view import RobotView


def small_snapshot(
    view: RobotView, program: str | None, is_student: Callable[[Operator], bool]
) -> messages.SmallSnapshot:
    """Return the message part for a robot.

    Args:
        view: The robot.
        program: The address of the program that has it, `None` without one.
        is_student: Whether an operator belongs to a student.
    """
    robot = view.robot
    now, latest = robot.supervisor.snapshot, robot.supervisor.snapshots.latest
    pose = view.scene.robot_in_map(latest.odometry.robot_in_odom) if latest else Pose2()
    why = robot.why_not_moving()
    by, driver = _driver(view, program, is_student)
    return messages.SmallSnapshot(
        robot=view.number,
        robot_in_map=(round(pose.x, 2), round(pose.y, 2), round(pose.theta, 2)),
        v=round(now.odometry.twist.v, 2) if now else 0.0,
        battery=round(latest.battery.voltage, 1) if latest else 0.0,
        stalled=now is not None and now.motors.stalled,
        emergency_stop=robot.supervisor.pilot.emergency,
        connected=now is not None,
        by=by,
        driver=driver,
        why=why and why.text,
    )


def _driver(
    view: RobotView, program: str | None, is_student: Callable[[Operator], bool]
) -> tuple[Literal["student", "teacher", "program", "mode"] | None, str | None]:
    """Return the kind of driver, and its name."""
    if program is not None:
        return "program", program
    driver = view.control.driver()
    if driver is None or isinstance(driver, str):
        return ("mode", driver) if driver else (None, None)
    return ("student" if is_student(driver) else "teacher"), driver.name
