"""Columns and gauges that the driving modes share (facts.md 8.3, 8.4)."""

from pioneer3.demo.modes.cockpit import Cockpit
from pioneer3.demo.modes.mode import Gauge
from pioneer3.demo.modes.row import Cell, Row, degrees_tenths, millimetres, tenths, whole_degrees
from pioneer3.geometry import Pose2
from pioneer3.state import Snapshot
from pioneer3.units import DEGREE

WIDTH = 10


def motion(snapshot: Snapshot, pose: Pose2) -> tuple[Cell, ...]:
    """Return `transVel rotVel x y th volts`, each ten wide."""
    twist = snapshot.odometry.twist
    return (
        Cell("transVel", WIDTH, millimetres(twist.v)),
        Cell("rotVel", WIDTH, whole_degrees(twist.w)),
        Cell("x", WIDTH, millimetres(pose.x)),
        Cell("y", WIDTH, millimetres(pose.y)),
        Cell("th", WIDTH, degrees_tenths(pose.theta)),
        Cell("volts", WIDTH, tenths(snapshot.battery.voltage)),
    )


def wandering_row(cockpit: Cockpit) -> Row | None:
    """Return the columns of the wander mode."""
    snapshot = cockpit.snapshot
    return Row(motion(snapshot, cockpit.pose(snapshot))) if snapshot else None


def driving_row(
    snapshot: Snapshot, pose: Pose2, *, has_charge: bool = False, emergency: bool = False
) -> Row:
    """Return the columns of the teleop modes.

    Args:
        snapshot: What the robot says.
        pose: Where it is [m, rad].
        has_charge: Whether the robot has ever told its state of charge.
        emergency: Whether our own emergency stop is latched, too.
    """
    cells = motion(snapshot, pose)
    if has_charge:
        cells += (Cell("soc", WIDTH, tenths(100 * (snapshot.battery.charge or 0.0))),)
    flags = {
        "[ESTOP]": snapshot.motors.stop_button or emergency,
        "[STALL]": snapshot.motors.stalled,
        "[DISABLED]": not snapshot.motors.enabled,
    }
    return Row(cells, tail="".join(f" {flag}" for flag, up in flags.items() if up))


def speed_gauges(cockpit: Cockpit) -> tuple[Gauge, ...]:
    """Return how fast the robot is, of what it may be."""
    snapshot, limits = cockpit.snapshot, cockpit.robot.info.limits
    if snapshot is None:
        return ()
    twist = snapshot.odometry.twist
    return (
        Gauge(
            name="speed", share=twist.v / limits.max_speed, text=f"{twist.v:+z.2f} m/s", signed=True
        ),
        Gauge(
            name="turn",
            share=-twist.w / limits.max_turn_rate,
            text=f"{twist.w / DEGREE:+z.0f} deg/s",
            signed=True,
        ),
    )
