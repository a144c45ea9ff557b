"""Starts the demo, on a screen or as lines, and runs it until a key or the terminal ends it."""

import sys
from collections.abc import Callable
from contextlib import nullcontext
from functools import partial

from pioneer3.demo.plain import Plain, serve_plain, typed
from pioneer3.demo.program import Program
from pioneer3.robot.devices import Acts
from pioneer3.robot.supervisor import kind
from pioneer3.runtime.robot import Robot
from pioneer3.teleop.terminal import raw_terminal


async def start_screen(robot: Robot, *, first: str, patience: float, acts: Acts) -> int:
    """Run the demo on the whole terminal; return the exit code."""
    from pioneer3.demo.app import DemoApp  # textual takes its time
    from pioneer3.teleop.screen import log_told_by, run_app

    app = DemoApp(partial(Program, robot, first=first, patience=patience, acts=acts))
    with log_told_by(app.say):
        await run_app(app)
    app.raise_failure()
    return app.return_code or 0


async def start_plain(
    robot: Robot, write: Callable[[str], None], *, first: str, patience: float, acts: Acts
) -> int:
    """Run the demo as lines that `write` takes, with keys from standard input."""
    face = Plain(write)
    write(f"{kind(robot.info)}: {robot.info.model.title} on {robot.info.url}")
    program = Program(robot, face, first=first, patience=patience, acts=acts)
    is_terminal = sys.stdin is not None and sys.stdin.isatty()
    with raw_terminal() if is_terminal else nullcontext(0) as descriptor:
        await serve_plain(program, face, typed(descriptor))
    return 0
