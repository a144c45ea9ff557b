"""Reads the XML of worlds of Gazebo, and finds the files that they name.

Documents with entities of their own are refused; size, number and depth have limits.
"""

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from xml.parsers.expat import ExpatError, ParserCreate

from pioneer3.errors import ConfigError
from pioneer3.sim.relief.shapes import FARTHEST
from pioneer3.sim.worldfile.stage_text import ABOVE, places_of
from pioneer3.text import POINTER, decoded, one_line, read_bytes, shown, wrong

LARGEST_SDF = 8 << 20
"""Larger files are not read [bytes]."""
MOST_FILES = 200
"""Most files of one world."""
MOST_MISSING = 1000
"""Most files of one world that are nowhere."""
MOST_ELEMENTS = 200_000
"""Most elements of all files of one world."""
DEEPEST = 100
"""Deepest nesting of elements."""
PATHS = (
    "GZ_SIM_RESOURCE_PATH",
    "IGN_GAZEBO_RESOURCE_PATH",
    "GAZEBO_MODEL_PATH",
    "GAZEBO_RESOURCE_PATH",
    "SDF_PATH",
    "ROS_PACKAGE_PATH",
)
"""Variables of the environment: folders in which Gazebo looks for models."""
_SCHEMES = ("model://", "package://", "file://")
_AMPERSAND = re.compile(r"&(?!(?:amp|lt|gt|quot|apos|#\d+|#x[\da-fA-F]+);)")
_DECLARATION = re.compile(r"\A\s*<\?xml[^>]*>")


@dataclass(frozen=True, slots=True, kw_only=True)
class SdfElement:
    """An element of SDF; its text is without blanks around it."""

    tag: str
    path: Path
    number: int
    attributes: dict[str, str]
    children: list["SdfElement"] = field(default_factory=list)
    pieces: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The text in it, without that of its children."""
        return "".join(self.pieces).strip()

    @property
    def name(self) -> str:
        """Its attribute `name`."""
        return self.attributes.get("name", "")

    def all(self, *tags: str) -> Iterator["SdfElement"]:
        """Yield the children with one of these tags."""
        return (child for child in self.children if child.tag in tags)

    def first(self, tag: str) -> "SdfElement | None":
        """Return the first child of this tag."""
        for child in self.children:
            if child.tag == tag:
                return child
        return None

    def told(self, key: str) -> str:
        """Return the text of a child, or an attribute as in SDF 1.0; empty if there is neither."""
        child = self.first(key)
        return child.text if child else self.attributes.get(key, "").strip()

    def numbers(self, key: str, count: int, most: float = FARTHEST) -> tuple[float, ...]:
        """Return `count` numbers of a child or attribute, none where it is missing or empty."""
        child = self.first(key)
        return (child or self).read(key, self.told(key), count, most)

    def read(self, key: str, text: str, count: int, most: float = FARTHEST) -> tuple[float, ...]:
        """Return `count` numbers of a text, none where it is empty; errors as for `numbers`."""
        if not text:
            return ()
        words = text.split(None, count)
        try:
            found = tuple(map(float, words))
        except ValueError:
            found = ()
        if len(found) != count or not all(map(isfinite, found)):
            expected = f"{count} numbers" if count > 1 else "a number"
            raise self.wrong(f"expected {expected}, not {shown(text)}", key)
        if max(map(abs, found)) > most:
            raise self.wrong(f"{shown(text)} is not within {most:g}", key)
        return found

    def wrong(self, problem: str, key: str = "") -> ConfigError:
        """Return the error about this element."""
        return wrong(self.path, f"{self.number}: {key or self.tag}: {problem}")


class SdfFiles:
    """The files of one world, each read once, within the limits.

    `missing` names those that are nowhere, each once, with the line that names it.
    """

    def __init__(self) -> None:
        self.missing: dict[str, str] = {}
        self._found: dict[tuple[str, Path], Path | None] = {}
        self._roots: dict[Path, SdfElement] = {}
        self._elements = 0

    def root(self, path: Path) -> SdfElement:
        """Return the root of a file."""
        key = path.resolve()
        if key not in self._roots:
            if len(self._roots) >= MOST_FILES:
                raise wrong(path, f" is one too many: a world has no more than {MOST_FILES} files")
            self._roots[key] = self._parsed(path)
        return self._roots[key]

    def find(self, uri: str, said: SdfElement) -> Path | None:
        """Return the file or folder that a URI of a file names, or `None` and note it."""
        key = uri, said.path
        if key not in self._found:
            self._found[key] = self._searched(uri, said)
        if self._found[key] is None:
            self.missing.setdefault(uri, f"{said.path.name}:{said.number}")
        return self._found[key]

    def _searched(self, uri: str, said: SdfElement) -> Path | None:
        name = uri
        for scheme in _SCHEMES:
            name = name.removeprefix(scheme)
        if "://" not in name:
            for path in self._candidates(name, said.path):
                with suppress(OSError, ValueError):
                    if path.exists() and not _is_pointer(path):
                        return path
        if len(self.missing) > MOST_MISSING:
            raise said.wrong(f"more than {MOST_MISSING} files that are not on this computer")
        return None

    def model(self, uri: str, said: SdfElement) -> SdfElement | None:
        """Return the root of the model that a URI names; `None` as for :meth:`find`."""
        found = self.find(uri, said)
        if found is None or found.is_file():
            return self.root(found) if found else None
        files = []
        with suppress(OSError):
            files = sorted(found.glob("*.sdf"))
        config = found / "model.config"
        if config.is_file():
            told = [found / each.text for each in self.root(config).all("sdf")]
            files = [path for path in told if path.is_file()] or files
        if not files:
            self.missing.setdefault(uri, f"{said.path.name}:{said.number}")
        return self.root(files[-1]) if files else None

    def _candidates(self, name: str, said: Path) -> Iterator[Path]:
        """Yield the places where a file may be."""
        above = said.resolve().parents[:ABOVE]
        told = [each for key in PATHS for each in os.environ.get(key, "").split(os.pathsep) if each]
        yield Path(name)
        for folder in above:
            yield folder / name
        for folder in (*map(Path, told), Path.home() / ".gazebo/models"):
            yield folder / name
            yield folder / "models" / name
        for folder in above:
            yield folder / "models" / name
        yield from places_of(name, said)

    def _parsed(self, path: Path) -> SdfElement:
        text = _plain(decoded(read_bytes(path, LARGEST_SDF, "world")))
        parser, open_elements = ParserCreate(), list[SdfElement]()
        roots: list[SdfElement] = []

        def refused(word: str, problem: str) -> ConfigError:
            return wrong(path, f"{parser.CurrentLineNumber}: {shown(word)}: {problem}")

        def start(tag: str, attributes: dict[str, str]) -> None:
            self._elements += 1
            if self._elements > MOST_ELEMENTS or len(open_elements) >= DEEPEST:
                most = f"{MOST_ELEMENTS} elements, or {DEEPEST} in each other"
                raise refused(tag, f"a world of more than {most}")
            number = parser.CurrentLineNumber
            element = SdfElement(tag=tag, path=path, number=number, attributes=attributes)
            (open_elements[-1].children if open_elements else roots).append(element)
            open_elements.append(element)

        def data(text: str) -> None:
            open_elements[-1].pieces.append(text)

        def entity(name: str, *_rest: object) -> None:
            raise refused(name, "entities are not read; write out what they stand for")

        parser.buffer_text = True
        parser.StartElementHandler, parser.EntityDeclHandler = start, entity
        parser.EndElementHandler = lambda _: open_elements.pop()
        parser.CharacterDataHandler = data
        try:
            parser.Parse(text, True)
        except ExpatError as error:
            raise wrong(path, f"{error.lineno}: not valid XML: {one_line(error)}") from None
        return roots[0]


def _is_pointer(path: Path) -> bool:
    """Whether a file is one of Git LFS that was not fetched."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(len(POINTER)) == POINTER


def _plain(text: str) -> str:
    """Return XML without comments and its first line, all else on the same lines.

    Gazebo's own reader takes more than XML: `--` in a comment, a comment before the first line, `&`
    for itself.
    """
    pieces, at = [], 0
    while (start := text.find("<!--", at)) >= 0 and (end := text.find("-->", start + 4)) >= 0:
        pieces += [text[at:start], "\n" * text.count("\n", start, end)]
        at = end + 3
    plain = _AMPERSAND.sub("&amp;", "".join([*pieces, text[at:]]))
    return _DECLARATION.sub(lambda told: "\n" * told[0].count("\n"), plain, count=1)


def descendants(element: SdfElement, tags: Sequence[str]) -> Iterator[SdfElement]:
    """Yield the elements with one of these tags that are anywhere in an element."""
    for child in element.children:
        if child.tag in tags:
            yield child
        yield from descendants(child, tags)
