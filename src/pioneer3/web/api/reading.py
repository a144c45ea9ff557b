"""Robots and their snapshots, as the API tells of them."""

from math import isfinite

from pioneer3.state import Snapshot
from pioneer3.web.api import types
from pioneer3.web.robot_view import RobotView


def described(view: RobotView) -> types.Robot:
    """Return who a robot is, and how it stands with the link."""
    robot = view.robot
    info, status = robot.info, robot.supervisor.status.latest
    return types.Robot(
        number=view.number,
        name=view.name,
        model=info.model.name,
        title=info.model.title,
        url=info.url,
        connection=status.connection.value if status else "connecting",
        max_speed=info.limits.max_speed,
        max_turn_rate=info.limits.max_turn_rate,
    )


def read(view: RobotView, now: Snapshot) -> types.Snapshot:
    """Return one reading, and who drives."""
    pose, twist = now.odometry.robot_in_odom, now.odometry.twist
    driver = view.control.driver()
    return types.Snapshot(
        sequence=now.sequence,
        pose=types.Pose(pose.x, pose.y, pose.theta),
        velocity=types.Velocity(twist.v, twist.w),
        sonar=types.Sonar(
            now.sonar.enabled, [r if isfinite(r) else None for r in now.sonar.ranges]
        ),
        battery=types.Battery(
            now.battery.voltage, now.battery.charge, now.battery.charging.value, now.battery.low
        ),
        motors=types.Motors(
            now.motors.enabled, now.motors.stalled, now.motors.moving, now.motors.stop_button
        ),
        bumpers=types.Bumpers(list(now.bumpers.front), list(now.bumpers.rear)),
        faults=list(now.faults),
        emergency_stop=view.robot.supervisor.pilot.emergency,
        why=view.robot.why_not_moving(),
        driver=driver if driver is None or isinstance(driver, str) else driver.name,
    )
