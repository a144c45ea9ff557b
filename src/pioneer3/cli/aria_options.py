"""Options with one dash, as ARIA and MobileSim have them: what stands in their place."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from pioneer3.errors import ConfigError

SIMULATOR: Final = "sim"
"""The command that takes MobileSim's options; all others take ARIA's."""
NAMING: Final = (["robot", "show"], ["robot", "edit"])
"""Commands that take a name alone, which may be that of an option."""
LONG: Final = re.compile(r"-[A-Za-z][A-Za-z]+\d?")
"""An option with one dash and several letters, which none of ours has."""
SIMULATOR_LONG: Final = frozenset(
    (
        *("map", "nomap", "robot", "port", "start", "cwd", "html", "resolution", "verbose"),
        *("noninteractive", "stageworld", "daemonize"),
    )
)
"""Options of MobileSim that are one word; others with one dash are short ones that are joined."""
END: Final = "--"
"""Word after which none is an option."""
LASER_KINDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "lms2xx": "lms-200",
        "lms1xx": "lms-111",
        "lms5xx": "lms-511",
        "tim3xx": "tim551",
        "tim5xx": "tim551",
        "tim551": "tim551",
        "tim561": "tim561",
        "tim571": "tim571",
        "urg": "urg-04lx",
        "urg2.0": "urg-04lx",
    }
)
"""Our lasers by the types of ARIA's `-laserType`."""
VALUES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "remotehost": "host",
        "rh": "host",
        "remoterobottcpport": "tcp",
        "rrtp": "tcp",
        "robotport": "--port",
        "rp": "--port",
        "robotbaud": "--baud",
        "rb": "--baud",
        "laserport": "laser",
        "lp": "laser",
        "lasertype": "kind",
        "lt": "kind",
    }
)
"""Our options, or parts of them, that the values of ARIA's options become."""
NO_EFFECT: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(
            ("connectlaser", "cl"), "the laser of a simulator is used; --laser names another"
        ),
        **dict.fromkeys(("connectsonar", "cs"), "sonars come with the robot"),
        **dict.fromkeys(("remoteissim", "ris", "remoteisnotsim", "rins"), "the robot tells that"),
        **dict.fromkeys(
            (
                *("robotlogpacketsreceived", "rlpr", "robotlogpacketssent", "rlps"),
                *("robotlogmovementreceived", "rlmr", "robotlogmovementsent", "rlms"),
                *("robotlogvelocitiesreceived", "rlvr", "robotlogactions", "rla"),
            ),
            "--record FILE writes every byte and every decision",
        ),
    }
)
"""The reasons why options of ARIA without a value change nothing."""
REFUSED: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(
            ("laserflipped", "lf"), "give --laser-pose x,y,heading,upside-down, such as 16cm,0,0"
        ),
        **dict.fromkeys(
            ("laserdegrees", "ld", "laserdegreesstart", "lds", "laserdegreesend", "lde"),
            "give --laser-mask with the sectors to leave out, such as -180:-90,90:180",
        ),
        **dict.fromkeys(
            ("laserporttype", "lpt", "remotelasertcpport", "rltp"),
            "give --laser with a URL, such as tim551@tcp://192.168.0.1:2112",
        ),
        **dict.fromkeys(("ptz", "ptz1", "gpsport", "gpstype"), "programs use robot.devices"),
    }
)
"""The remedies for options of ARIA that cannot be left out."""


def in_our_words(words: Sequence[str], warn: Callable[[str], None]) -> list[str]:
    """Return the words of a command line with ARIA's or MobileSim's options in our form.

    Args:
        words: The command first.
        warn: Told of options that have no effect.

    Raises:
        ConfigError: An option of ARIA has another form here, which is told.
    """
    if words[:1] == [SIMULATOR]:
        return [f"-{w}" if w[:1] == "-" and w[1:] in SIMULATOR_LONG else w for w in words]
    if list(words[:2]) in NAMING:
        return list(words)
    end = words.index(END) if END in words else len(words)
    kept: list[str] = []
    parts: dict[str, str] = {}
    rest = iter(words[:end])
    for word in rest:
        name = _name(word)
        if name in VALUES:
            parts[VALUES[name]] = _value(word, rest)
        elif name in REFUSED:
            raise ConfigError(f"{word} is ARIA's: {REFUSED[name]}")
        elif name in NO_EFFECT:
            warn(f"{word} has no effect: {NO_EFFECT[name]}")
        else:
            kept.append(word)
    return [*kept, *(word for option in _options(parts) for word in option), *words[end:]]


def _name(word: str) -> str:
    """Return the name of an option of ARIA; empty for a word that can be none."""
    return word[1:].lower() if LONG.fullmatch(word) else ""


def _value(word: str, rest: Iterator[str]) -> str:
    value = next(rest, None)
    if value is None or _name(value) in (*VALUES, *NO_EFFECT, *REFUSED):
        raise ConfigError(f"{word}: its value is missing")
    return value


def _options(parts: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield our options with their values."""
    if "host" in parts or "tcp" in parts:
        yield "--port", f"tcp://{parts.get('host', 'localhost')}:{parts.get('tcp', '8101')}"
    for option in ("--port", "--baud"):
        if option in parts:
            yield option, parts[option]
    if "kind" in parts or "laser" in parts:
        kind = parts.get("kind", "")
        known = LASER_KINDS.get(kind.lower())
        if kind and known is None:
            raise ConfigError(f"-laserType {kind}: known are {', '.join(LASER_KINDS)}")
        if "laser" not in parts:
            raise ConfigError("-laserType: give the laser's port, too: -laserPort /dev/ttyUSB1")
        yield "--laser", f"{known}@{parts['laser']}" if known else parts["laser"]
