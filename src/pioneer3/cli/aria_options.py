"""Options with one dash, as ARIA and MobileSim have them: what stands in their place."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.links.urls import HOST_AND_PORT, TCP_PORT


def _by_word(rows: Mapping[str, str]) -> Mapping[str, str]:
    """Return the meanings of words, of rows that have several words of one meaning."""
    return MappingProxyType({word: row for row, words in rows.items() for word in words.split()})


SIMULATOR: Final = "sim"
"""The command that takes MobileSim's options; all others take ARIA's."""
NAMING: Final = (["robot", "show"], ["robot", "edit"])
"""Commands that take a name alone, which may be that of an option."""
LONG: Final = re.compile(r"--?[A-Za-z][A-Za-z]+\d?")
"""An option of several letters, which ARIA takes with one dash or two, and any case."""
FIRST: Final = "1"
"""Number of the laser whose options end in no digit."""
SIMULATOR_LONG: Final = frozenset(
    (
        *("map", "nomap", "robot", "port", "start", "cwd", "verbose", "stageworld"),
        *("bind-to-address", "log-file", "no-network-discovery", "odom-error-mode"),
    )
)
"""Options of MobileSim that are one word; others with one dash are short ones that are joined."""
SIMULATOR_SILENT: Final = frozenset(
    (
        *("no-gui", "no-graphics", "lite-graphics"),
        *("fullscreen-gui", "maximize-gui", "minimize-gui"),
        *("noninteractive", "no-crash-debug", "no-crash-restart"),
    )
)
"""Options of MobileSim that change nothing: no window opens, nothing is asked or started again."""
SIMULATOR_NO_EFFECT: Final = _by_word(
    {
        "the log is plain text": "html",
        "a program of ours writes every byte with --record": (
            "log-packets-received log-movement-sent"
        ),
        "unknown commands are ignored, as robots ignore them": "warn-unsupported-commands",
        "nothing is made by Stage": "echo-stage-worldfile",
        "the commands 62 and 66 to 69 are not obeyed; 224 and 225 are": "srisim-compat",
        "the commands 35 to 38 are obeyed": "no-srisim-laser-compat",
    }
)
"""The reasons why options of MobileSim without a value change nothing."""
SIMULATOR_VALUE_WITHOUT_EFFECT: Final = _by_word(
    {
        "robots report every 100 ms of simulated time; see --speed": "update-interval",
        "the world moves in steps of 20 ms; see --speed": "update-sim-time",
        "walls are exact, there is no grid": "resolution",
        "every command is obeyed": "ignore-command",
        "the log is one file": "log-file-max-size",
        "the time that steps take is told to programs that ask for SIMSTAT": "log-timing-stats",
        "maps are loaded at once": "lines-chunksize points-chunksize",
    }
)
"""The reasons why options of MobileSim with a value change nothing."""
SIMULATOR_REFUSED: Final = {
    "daemonize": "it stays in the foreground; end the line with &, or let systemd start it",
}
"""The remedies for options of MobileSim without which a script would go wrong."""
END: Final = "--"
"""Word after which none is an option."""
LASER_KINDS: Final = _by_word(
    {
        "lms-200": "lms2xx",
        "lms-111": "lms1xx",
        "lms-511": "lms5xx",
        "tim551": "tim3xx tim5xx tim551",
        "tim561": "tim561",
        "tim571": "tim571",
        "urg-04lx": "urg urg2.0",
    }
)
"""Our lasers by the types of ARIA's `-laserType`."""
VALUES: Final = _by_word(
    {
        "host": "remotehost rh",
        "tcp": "remoterobottcpport rrtp",
        "--port": "robotport rp",
        "--baud": "robotbaud rb",
        "laser": "laserport lp",
        "kind": "lasertype lt",
    }
)
"""Our options, or parts of them, that the values of ARIA's options become."""
LASER_PARTS: Final = frozenset(("laser", "kind"))
"""Values of which each laser has its own."""
NO_EFFECT: Final = _by_word(
    {
        "the laser of a simulator is used; --laser names another": "connectlaser cl",
        "sonars come with the robot": "connectsonar cs",
        "the robot tells that": "remoteissim ris remoteisnotsim rins",
        "--record FILE writes every byte and every decision": (
            "robotlogpacketsreceived rlpr robotlogpacketssent rlps robotlogmovementreceived rlmr "
            "robotlogmovementsent rlms robotlogvelocitiesreceived rlvr robotlogactions rla "
            "sonarlogpacketsreceived slpr sonarlogpacketssent slps batterylogpacketsreceived blpr "
            "batterylogpacketssent blps lcdlogpacketsreceived lcdlpr lcdlogpacketssent lcdlps"
        ),
    }
)
"""The reasons why options of ARIA without a value change nothing."""
VALUE_WITHOUT_EFFECT: Final = _by_word(
    {
        "the laser's speed is found": "laserstartingbaud lsb laserautobaud lab",
        "the laser measures as its type does": (
            "laserincrement li laserincrementbydegrees libd laserunits lu lasermaxrange lmr "
            "laserreflectorbits lrb"
        ),
        "a laser is waited for until it has power and answers": "laserpowercontrolled lpc",
    }
)
"""The reasons why options of ARIA with a value change nothing."""
REFUSED: Final = _by_word(
    {
        "give --laser-pose x,y,heading,upside-down, such as 16cm,0,0": "laserflipped lf",
        "give --laser-mask with the sectors to leave out, such as -180:-90,90:180": (
            "laserdegrees ld laserdegreesstart lds laserdegreesend lde "
            "laseradditionalignorereadings lair"
        ),
        "give --laser with a URL, such as tim551@tcp://192.168.0.1:2112": (
            "laserporttype lpt remotelasertcpport rltp"
        ),
        "programs use robot.devices": (
            "ptz ptztype gpsport gpstype gpsbaud remotegpstcphost remotegpstcpport compassport "
            "compasstype ptzserialport ptzinverted ptzrobotauxserialport ptzaddress ptztcpport "
            "ptzusername ptzpassword"
        ),
    }
)
"""The remedies for options of ARIA that cannot be left out."""
KNOWN: Final = frozenset((*VALUES, *NO_EFFECT, *VALUE_WITHOUT_EFFECT, *REFUSED))
"""Names of ARIA's options, in lower case."""


def in_our_words(words: Sequence[str], warn: Callable[[str], None]) -> list[str]:
    """Return the words of a command line with ARIA's or MobileSim's options in our form.

    Args:
        words: The command first.
        warn: Told of options that have no effect.

    Raises:
        ConfigError: An option has another form here, which is told.
    """
    if words[:1] == [SIMULATOR]:
        return [*_simulator_words(iter(words), warn)]
    if list(words[:2]) in NAMING:
        return list(words)
    end = words.index(END) if END in words else len(words)
    kept: list[str] = []
    told: dict[str, str] = {}
    lasers: dict[str, dict[str, str]] = {}
    rest = iter(words[:end])
    for word in rest:
        name, number = _name(word)
        if part := VALUES.get(name):
            of = lasers.setdefault(number, {}) if part in LASER_PARTS else told
            of[part] = _value(word, rest)
        elif name in REFUSED:
            raise ConfigError(f"{word} is ARIA's: {REFUSED[name]}")
        elif why := NO_EFFECT.get(name) or VALUE_WITHOUT_EFFECT.get(name):
            if name in VALUE_WITHOUT_EFFECT:
                _value(word, rest)
            warn(f"{word} has no effect: {why}")
        else:
            kept.append(word)
    options = [
        *_robot_options(told, kept, warn),
        *(_laser_option(lasers[each]) for each in sorted(lasers)),
    ]
    return [*kept, *(word for option in options for word in option), *words[end:]]


def _simulator_words(words: Iterator[str], warn: Callable[[str], None]) -> Iterator[str]:
    """Yield the words with MobileSim's options in our form."""
    warned: set[str] = set()
    for word in words:
        name, equals, _ = word.lstrip("-").partition("=") if word[:1] == "-" else ("", "", "")
        if name in SIMULATOR_REFUSED:
            raise ConfigError(f"--{name} is not supported: {SIMULATOR_REFUSED[name]}")
        why = SIMULATOR_NO_EFFECT.get(name) or SIMULATOR_VALUE_WITHOUT_EFFECT.get(name)
        if name in SIMULATOR_VALUE_WITHOUT_EFFECT and not equals:
            _value(word, words)
        if why and name not in warned:
            warned.add(name)
            warn(f"--{name} has no effect: {why}")
        if not why and name not in SIMULATOR_SILENT:
            yield f"-{word}" if word[:1] == "-" and word[1:] in SIMULATOR_LONG else word


def _name(word: str) -> tuple[str, str]:
    """Return the name of an option of ARIA, and of which laser; empty for other words."""
    name = word.lstrip("-").lower() if LONG.fullmatch(word) else ""
    bare = name.rstrip("0123456789")
    return (bare, name.removeprefix(bare) or FIRST) if bare in KNOWN else ("", "")


def _value(word: str, rest: Iterator[str]) -> str:
    value = next(rest, None)
    if value is None or _name(value)[0]:
        raise ConfigError(f"{word}: its value is missing")
    return value


def _robot_options(
    told: Mapping[str, str], kept: Sequence[str], warn: Callable[[str], None]
) -> Iterator[tuple[str, str]]:
    """Yield our options for the robot; a host comes before a serial port, as in ARIA."""
    ours = next((each for each in kept if each.partition("=")[0] in {"--port", "-p"}), None)
    if ours and told.keys() & {"host", "tcp", "--port"}:
        raise ConfigError(f"{ours} and ARIA's option for the robot's port: give one of them")
    if "host" in told or "tcp" in told:
        if "--port" in told:
            warn("-robotPort has no effect: the robot is asked for on the network")
        yield "--port", _url(told.get("host", "localhost"), told.get("tcp"))
    elif "--port" in told:
        yield "--port", told["--port"]
    if "--baud" in told:
        yield "--baud", told["--baud"]


def _url(host: str, tcp: str | None) -> str:
    """Return the URL of a robot on the network, also for a host that says the port by itself."""
    host = host.removeprefix("tcp://").rstrip("/")
    if host.count(":") > 1 and not host.startswith("["):
        host = f"[{host}]"
    has_port = tcp is None and HOST_AND_PORT.fullmatch(host)
    return f"tcp://{host}" if has_port else f"tcp://{host}:{tcp or TCP_PORT}"


def _laser_option(parts: Mapping[str, str]) -> tuple[str, str]:
    """Return our option for a laser."""
    kind = parts.get("kind", "")
    known = LASER_KINDS.get(kind.lower())
    if kind and known is None:
        raise ConfigError(f"-laserType {kind}: known are {', '.join(LASER_KINDS)}")
    if "laser" not in parts:
        raise ConfigError("-laserType: give the laser's port, too: -laserPort /dev/ttyUSB1")
    return "--laser", f"{known}@{parts['laser']}" if known else parts["laser"]
