"""The state of localization and of the goal, for diagnostic_msgs."""

from math import isfinite
from typing import TYPE_CHECKING

from pioneer3.ros.messages.diagnostics import DiagnosticLevel, DiagnosticStatus

if TYPE_CHECKING:
    from pioneer3.nav.estimate import Estimate
    from pioneer3.navigation.navigator import Navigation


def navigation_status(
    map_name: str, estimate: "Estimate", state: "Navigation | None"
) -> tuple[DiagnosticStatus, DiagnosticStatus]:
    """Return the states of localization and of navigation.

    Args:
        map_name: Name of the map.
        estimate: Where the robot is.
        state: Of the navigator, or `None` before its first snapshot.
    """
    return _localization(map_name, estimate), _goal(state)


def _localization(map_name: str, estimate: "Estimate") -> DiagnosticStatus:
    pose, deviation = estimate.robot_in_map, estimate.deviation
    known = pose if estimate.stage != "lost" else None
    return DiagnosticStatus(
        part="Localization",
        level=DiagnosticLevel.OK if estimate.sure else DiagnosticLevel.WARN,
        message=estimate.reason if estimate.sure else f"not sure: {estimate.reason}",
        values=(
            ("map", map_name),
            ("sure", "yes" if estimate.sure else "no"),
            ("stage", estimate.stage),
            ("agreement", f"{estimate.agreement:.2f}"),
            ("deviation", f"{deviation:.3f}" if isfinite(deviation) else ""),
            ("x", f"{known.x:.3f}" if known else ""),
            ("y", f"{known.y:.3f}" if known else ""),
            ("heading", f"{known.theta:.3f}" if known else ""),
        ),
    )


def _goal(state: "Navigation | None") -> DiagnosticStatus:
    goal, problem, left = state and state.goal, state.problem if state else "", ""
    if state is not None and state.way is not None and state.estimate.robot_in_map is not None:
        here = state.estimate.robot_in_map
        left = f"{state.way.rest_from(here.x, here.y).length:.1f}"
    message = f"on the way to {goal}" if goal else "no goal"
    return DiagnosticStatus(
        part="Navigation",
        level=DiagnosticLevel.WARN if problem else DiagnosticLevel.OK,
        message=f"{message}: {problem}" if problem else message,
        values=(("goal", str(goal or "")), ("left", left), ("problem", problem)),
    )
