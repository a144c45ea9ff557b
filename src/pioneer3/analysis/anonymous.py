"""A log without names: of robots, users, hosts, places and files, addresses and serial numbers.

Numbers stay. The names that a log tells are gathered first; then all of its texts are written
without them, and without whatever has the form of an address or a path. Bytes of lasers are left
out, as their serial numbers are in each scan; the scans themselves stay.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Set
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import msgspec

from pioneer3.analysis.anonymous_bytes import STRANGER, LinkScrubber
from pioneer3.analysis.open_log import OpenLog
from pioneer3.errors import ConfigError
from pioneer3.limits import Limits
from pioneer3.log.folder import create
from pioneer3.log.mcap import McapFile
from pioneer3.log.reader import RunLog
from pioneer3.log.topics import LogEvent, LogTopic
from pioneer3.maps.aria_objects import STANDARD_LINES, STANDARD_SOLIDS
from pioneer3.maps.write import KNOWN, aria_text
from pioneer3.models import RobotModel, load_model, model_names
from pioneer3.navigation.goals import GoalChanged
from pioneer3.navigation.recording import MapUsed, WayPlanned, kind_of
from pioneer3.robot.supervisor import Connection
from pioneer3.runtime.recording import GIVES_MOTION, TruePoseTold
from pioneer3.state import Scan, Snapshot
from pioneer3.text import wrong

FORMS: Final = (
    (
        re.compile(r"\b[a-z][a-z0-9+.-]*:(//)?[^\s,;'\"]*[/:@.\d][^\s,;'\"]*", re.IGNORECASE),
        "ADDRESS",
    ),
    (re.compile(r"[\w.+-]+@[\w.-]+"), "ADDRESS"),
    (re.compile(r"\b\d{1,3}(\.\d{1,3}){3}\b(:\d+)?"), "ADDRESS"),
    (
        re.compile(
            r"\b([0-9a-f]{2}:){5}[0-9a-f]{2}\b|\b[0-9a-f]*(:[0-9a-f]*){3,}\b", re.IGNORECASE
        ),
        "ADDRESS",
    ),
    (re.compile(r"(?<![\w/°])(~[\w.-]*|\.{1,2})?/[^\s,;'\"]+"), "PATH"),
    (re.compile(r"\b[A-Z]:\\[^\s,;'\"]+"), "PATH"),
    (
        re.compile(
            r"\b([\w.-]+/)*[\w-]+(\.[\w-]+)*"
            r"\.(map|yaml|toml|world|sdf|mcap|bag|csv|py|p|json|txt|log|png|pgm|local|lan)\b",
            re.IGNORECASE,
        ),
        "FILE",
    ),
)
"""Forms of addresses and paths, and the words that take their place."""
TELLING: Final = re.compile(r"(?<![^\s,;'\"])[^\s,;'\":/@.\\]*+[:/@.\\][^\s,;'\"]*+")
"""A word that may be of such a form."""
LONGEST_KNOWN: Final = 256
"""Longer words are not remembered."""
NO_NAMES: Final = {
    *("", "program", "ROS", "localhost", "robot", "laser", "Pioneer", "SIM", "open"),
    *Connection,
    *GIVES_MOTION,
}
"""Words where names stand that name nobody, or by which logs are read."""
COMMON: Final = re.compile(r".{1,2}|[a-z]{3,7}|\d{3,4}")
"""Names that may be parts of other words or numbers are looked for as whole words only."""
FIXED: Final = {"kind", "status", "channel", "symptom", "family", "controller", "drive"}
"""Fields with one of a few words."""
STANDARD: Final = KNOWN | STANDARD_LINES | STANDARD_SOLIDS
"""Kinds of places on maps that any map has."""
HOST: Final = re.compile(r"//(?:[^\s/@]*@)?([\w.-]{3,})")
"""Host in a URL."""
USERS: Final = re.compile(
    r"(.+?)( came, a \w+| left| (took|lost) control of .+| is called (?P<now>.+) now)", re.DOTALL
)
"""Event of a page: the name of a user, and the one from now on."""
NUMBER: Final = re.compile(r"[+-]?\d+(\.\d+)?[a-z°/]*")
"""An argument of a command that stays."""
OUR_COMMAND: Final = re.compile(r"[a-z][a-z0-9-]*")
"""The word behind `pioneer3`."""
OPTION: Final = re.compile(r"--?[a-z][a-z-]*")
"""Option of a command."""
ERROR: Final = re.compile(r"(\w+): .*", re.DOTALL)
"""An error that ended a log, in the words of its program: of a file, or what somebody asked for."""
SAME: Final = {"version", "began", "began_ns", "clock", "python", "system"}
"""Metadata about the program that name nobody."""
OF_ROBOT: Final = ("kind", "limits")
"""Metadata about a robot that name nobody."""
FLUSHED: Final = 10**9
"""Messages of such a time are written together [ns]."""
NAMING: Final = (GoalChanged, WayPlanned, MapUsed, RobotModel, LogEvent)
"""Messages that name users, places, maps, hosts and models."""
NUMBERS: Final = (Scan, Snapshot, Limits, TruePoseTold)
"""Messages without texts."""
WIRE: Final = "wire/"
"""Begin of the topics of bytes."""


@dataclass(slots=True)
class Names:
    """Names of a log, and what takes their places."""

    aliases: dict[str, str] = field(default_factory=dict)
    _pattern: re.Pattern[str] | None = None

    def add(self, kind: str, names: Iterable[str]) -> None:
        """Take names of a kind, such as `user`."""
        for name in sorted(names):
            if name and name not in NO_NAMES and name not in self.aliases:
                self.aliases[name] = f"{kind}-{len(self.aliases) + 1}"
                self._pattern = None

    def hidden(self, text: str) -> str:
        """Return a text without names, addresses and paths."""
        if self._pattern is None:
            longest = sorted(self.aliases, key=len, reverse=True)
            self._pattern = re.compile("|".join(map(_looked_for, longest)) or r"(?!)")
        text = TELLING.sub(_without_form, text)
        return self._pattern.sub(lambda found: self.aliases[found[0]], text)


def _looked_for(name: str) -> str:
    """Return the regular expression of a name."""
    plain = re.escape(name)
    is_common = COMMON.fullmatch(name)
    return rf"(?<![^\W_])(?<!\d\.){plain}(?![^\W_]|\.\d)" if is_common else plain


def _formless(word: str) -> str:
    """Return a word, or what takes the place of its form."""
    for form, alias in FORMS:
        word = form.sub(alias, word)
    return word


@lru_cache(4096)
def _known(word: str) -> str:
    return _formless(word)


def _without_form(found: re.Match[str]) -> str:
    return (_known if len(found[0]) < LONGEST_KNOWN else _formless)(found[0])


def write_anonymous(log: OpenLog, output: Path) -> int:
    """Write a log without names to a new file; return the number of its messages.

    Raises:
        ConfigError: The log is damaged, or the file cannot be written.
    """
    source = log.source
    names = _names_of(log, source)
    prefixes = {
        prefix: f"{names.aliases.get(name, name)}/" if prefix else ""
        for name, prefix in log.prefixes.items()
    }
    wires = _Wires(source, log.prefixes.values())
    try:
        file = McapFile(create(output))
    except OSError as error:
        raise ConfigError(f"{output}: cannot be written: {error.strerror}") from None
    done = False
    try:
        for name, texts in _texts(log.info().texts, names, prefixes):
            file.add_metadata(name, texts)
        written = _write(file, source, names, prefixes, wires)
        file.finish()
        done = True
    except OSError as error:
        raise ConfigError(f"{output}: cannot be written: {error.strerror}") from None
    except OverflowError as error:  # JSON has larger numbers than a log is written with
        raise wrong(source.path, f" is damaged: {error}") from None
    finally:
        if not done:
            output.unlink()
    return written


def _names_of(log: OpenLog, source: RunLog) -> Names:
    """Return the names in a log."""
    names = Names()
    texts = log.info().texts
    robots = [told for name, told in texts.items() if name.rpartition("/")[2] == "robot"]
    public = _public_names()
    names.add("model", {told.get("model", "") for told in robots} - public)
    names.add("robot", {*log.prefixes, *(told.get("name", "") for told in robots)} - public)
    for told in robots:
        names.add("host", re.findall(r"[\w.-]{3,}", told.get("url", "").partition(":")[2]))
        names.add("serial", {*_told(told, "configuration", "serial_number", "name")} - public)
        names.add("model", {*_told(told, "parameters", "name", "title")} - public)
    told_by = _Wires(source, log.prefixes.values()).scrubbers
    kinds = {topic: kind_of(topic) for topic in source.topics()}
    naming = {topic: kind for topic, kind in kinds.items() if kind in NAMING}
    for message in source.messages(lambda topic: topic in naming or topic in told_by):
        if scrubber := told_by.get(message.topic):
            scrubber.feed(message.time, message.data)
            scrubber.ready.clear()
        elif kind := naming.get(message.topic):
            _add_names(names, source.decoded(message, LogTopic(message.topic, kind)), public)
    heard = {name for each in told_by.values() for name in each.names}
    names.add("robot", heard - public)
    return names


def _public_names() -> set[str]:
    """Return the names and titles of the shipped models."""
    return {each for name in model_names() for each in (name, load_model(name).title)}


def _add_names(names: Names, message: Any, public: Set[str]) -> None:
    match message:
        case RobotModel():
            names.add("model", {message.name, message.title} - public)
        case LogEvent(kind="page"):
            if found := USERS.fullmatch(message.text):
                names.add("user", [found[1], found["now"] or ""])
        case LogEvent():
            names.add("host", HOST.findall(message.text))
        case GoalChanged():
            names.add("user", [message.by])
            names.add("place", [place.name for place in message.places])
        case WayPlanned():
            names.add("map", [message.map])
            names.add("place", [message.place.name] if message.place else [])
        case MapUsed():
            names.add("map", [message.file, Path(message.file).stem, message.name])
            objects = message.line_map.objects
            names.add("place", [each.name for each in objects])
            names.add("kind", {each.kind for each in objects} - STANDARD)


def _told(texts: Mapping[str, str], part: str, *keys: str) -> list[str]:
    """Return the texts of some keys in a part of a robot's description, which is JSON."""
    try:
        told = msgspec.json.decode(texts.get(part, ""))
    except msgspec.MsgspecError:
        return []
    told = told if isinstance(told, dict) else {}
    return [each for key in keys if isinstance(each := told.get(key), str)]


class _Wires:
    """The bytes of the robots' links without names; they are read once more, a little ahead."""

    def __init__(self, source: RunLog, prefixes: Iterable[str]) -> None:
        self.scrubbers = {
            f"{WIRE}{prefix}robot/{way}": LinkScrubber(is_command=way == "out")
            for prefix in prefixes
            for way in ("in", "out")
        }
        self._ahead = source.messages(self.scrubbers.__contains__)

    def next(self, topic: str) -> bytes:
        """Return the next piece of a topic."""
        ready = self.scrubbers[topic].ready
        while not ready:
            if (message := next(self._ahead, None)) is None:
                self.scrubbers[topic].end()
                return ready.popleft()
            self.scrubbers[message.topic].feed(message.time, message.data)
        return ready.popleft()


def _texts(
    texts: Mapping[str, Mapping[str, str]], names: Names, prefixes: Mapping[str, str]
) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield the descriptions in a log, without names."""
    for name, told in texts.items():
        prefix, slash, last = name.rpartition("/")
        if name == "program":
            kept = {key: told[key] for key in SAME if key in told}
            yield name, kept | {"command": _command(told.get("command", ""))}
        elif name == "end":
            yield name, {"why": names.hidden(ERROR.sub(r"\1", told.get("why", "")))}
        elif last == "robot" and prefix + slash in prefixes:
            kept = {key: told[key] for key in OF_ROBOT if key in told}
            kept |= {key: names.hidden(told.get(key, "")) for key in ("name", "model")}
            kept["configuration"] = _hidden_json(told.get("configuration", "null"))
            with suppress(KeyError, msgspec.MsgspecError):
                model = msgspec.json.decode(told["parameters"])
                kept["parameters"] = msgspec.json.encode(_mapped(model, names.hidden)).decode()
            yield f"{prefixes[prefix + slash]}robot", kept


def _hidden_json(configuration: str) -> str:
    """Return a robot's configuration without its name and serial number."""
    try:
        told = msgspec.json.decode(configuration)
    except msgspec.MsgspecError:
        return "null"
    if not isinstance(told, dict):
        return "null"
    hidden = {
        key: STRANGER * len(str(told[key])) for key in ("serial_number", "name") if told.get(key)
    }
    return msgspec.json.encode(told | hidden).decode()


def _command(line: str) -> str:
    """Return a command line: our own command, options, numbers; all else is left out."""
    first, *rest = line.split() or [""]
    is_ours = first in {"pioneer3", "p3"}
    kept = [first if is_ours else "python"]
    if is_ours and rest and OUR_COMMAND.fullmatch(rest[0]):
        kept.append(rest.pop(0))  # `goto` of `pioneer3 goto kitchen`
    for word in rest:
        option, equals, _ = word.partition("=")
        if OPTION.fullmatch(option):
            kept.append(f"{option}=***" if equals else option)
        else:
            kept.append(word if NUMBER.fullmatch(word) else "***")
    return " ".join(kept)


def _write(
    file: McapFile,
    source: RunLog,
    names: Names,
    prefixes: Mapping[str, str],
    wires: _Wires,
) -> int:
    """Write the messages of a log without names; return how many."""
    topics: dict[str, LogTopic[Any] | None] = {}
    waiting: dict[str, list[tuple[int, Any]]] = {}
    since = written = 0
    for message in source.messages():
        if message.topic not in topics:
            topics[message.topic] = _topic(message.topic, prefixes, wires.scrubbers)
        topic = topics[message.topic]
        if topic is None:
            continue
        if message.topic in wires.scrubbers:
            told: Any = wires.next(message.topic)
        else:
            told = source.decoded(message, LogTopic(message.topic, topic.kind))
            with source.damage_told():
                told = _without(told, names)
        if message.time - since > FLUSHED and waiting:
            _flush(file, topics, waiting)
            since = message.time
        waiting.setdefault(message.topic, []).append((message.time, told))
        written += 1
    _flush(file, topics, waiting)
    return written


def _flush(
    file: McapFile,
    topics: Mapping[str, LogTopic[Any] | None],
    waiting: dict[str, list[tuple[int, Any]]],
) -> None:
    for name, messages in waiting.items():
        if (topic := topics[name]) is not None:
            file.add(topic, messages)
    waiting.clear()
    file.flush()


def _topic(
    name: str, prefixes: Mapping[str, str], wires: Mapping[str, object]
) -> LogTopic[Any] | None:
    """Return the topic that takes the place of another; `None` if it is left out."""
    if name in wires:
        prefix, _, way = name.removeprefix(WIRE).rpartition("robot/")
        return LogTopic(f"{WIRE}{prefixes[prefix]}robot/{way}", bytes)
    kind = kind_of(name)
    if kind is None or kind is bytes:
        return None
    own = "scan/" if kind is Scan else ""
    head, _, last = name.rpartition(own or "/") if own else name.rpartition("/")
    prefix = head if own else head + ("/" if head else "")
    if prefix not in prefixes and kind is not LogEvent:
        return None
    return LogTopic(f"{prefixes.get(prefix, '')}{own}{last}", kind, steady="angles" if own else "")


def _without(message: Any, names: Names) -> Any:
    """Return a message without names."""
    if isinstance(message, NUMBERS):
        return message
    if isinstance(message, MapUsed):
        line_map = message.line_map
        places = [
            replace(each, name=names.hidden(each.name), kind=names.hidden(each.kind))
            for each in line_map.objects
        ]
        text = aria_text(replace(line_map, objects=tuple(places)))
        return MapUsed(name=names.hidden(message.name), file="", sha256="", text=text)
    if isinstance(message, LogEvent) and message.kind == "page":
        return LogEvent("page", "***")
    return msgspec.convert(_mapped(msgspec.to_builtins(message), names.hidden), type(message))


def _mapped(value: Any, change: Callable[[str], str]) -> Any:
    """Return a value with all texts changed, but the names of fields."""
    if isinstance(value, dict):
        return {key: each if key in FIXED else _mapped(each, change) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_mapped(each, change) for each in value]
    return change(value) if isinstance(value, str) else value
