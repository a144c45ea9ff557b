"""The log of a node of ROS 1: `/rosout`, and the services that set how much is logged."""

import logging
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, Final

from pioneer3.names import printable
from pioneer3.ros.tcpros.types import Ros1Types

TYPE: Final = "rosgraph_msgs/Log"
LEVELS: Final = {
    logging.DEBUG: 1,
    logging.INFO: 2,
    logging.WARNING: 4,
    logging.ERROR: 8,
    logging.CRITICAL: 16,
}
"""Levels of rosgraph_msgs/Log."""
LEVEL_NAMES: Final = {"debug", "info", "warn", "error", "fatal"}
"""Levels as services have them."""


class RosoutHandler(logging.Handler):
    """Gives `publish` a message of each record, by the thread that logs it."""

    def __init__(self, node: str, types: Ros1Types, publish: Callable[[Any], None]) -> None:
        super().__init__(logging.WARNING)
        self._node, self._types, self._publish = node, types, publish

    def emit(self, record: logging.LogRecord) -> None:
        """Publish a record."""
        try:
            message = self._types.make(TYPE)
            stamp = message.header.stamp
            stamp.sec, part = divmod(record.created, 1)
            stamp.sec, stamp.nanosec = int(stamp.sec), int(part * 1e9)
            message.level = LEVELS.get(record.levelno, LEVELS[logging.WARNING])
            message.name, message.msg = self._node, printable(record.getMessage())
            message.file, message.line = record.filename, record.lineno
            message.function = record.funcName or ""
            self._publish(message)
        except Exception:
            self.handleError(record)


def loggers(types: Ros1Types) -> Any:
    """Return the content of a response of roscpp/GetLoggers: all loggers with their levels."""
    found = []
    for name in sorted(logging.Logger.manager.loggerDict):
        each = types.make("roscpp/Logger")
        level = logging.getLevelName(logging.getLogger(name).getEffectiveLevel()).lower()
        each.name, each.level = name, {"warning": "warn", "critical": "fatal"}.get(level, level)
        found.append(each)
    return SimpleNamespace(loggers=found)


def set_level(request: Any) -> object:
    """Set the level of a logger as a roscpp/SetLoggerLevel says; ValueError for none."""
    level = str(request.level).lower()
    if level not in LEVEL_NAMES:
        raise ValueError(
            f"the level of a logger is {', '.join(sorted(LEVEL_NAMES))}, not {level!r}"
        )
    logging.getLogger(str(request.logger)).setLevel(level.upper())
    return None
