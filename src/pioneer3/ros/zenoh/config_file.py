"""Configuration files of Zenoh: which settings they have, and which secrets.

Zenoh itself tells a setting that a file has from its default only if they differ.
"""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import yaml

YAML: Final = {".yaml", ".yml"}
TOKEN: Final = re.compile(
    r"""(?P<space>\s+|//[^\n]*|/\*.*?\*/)
    |(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')
    |(?P<sign>[{}\[\]:,])
    |(?P<word>[^\s{}\[\]:,"'/]+)""",
    re.VERBOSE | re.DOTALL,
)
ESCAPE: Final = re.compile(r"\\(u[0-9a-fA-F]{4}|x[0-9a-fA-F]{2}|\r\n|.)", re.DOTALL)
ESCAPED: Final = dict(zip("bfnrtv0", "\b\f\n\r\t\v\0", strict=True)) | {"\n": "", "\r\n": ""}
FILES: Final = ("private_key", "private_key_file", "dictionary_file")
"""Ends of the names of settings whose values are files with secrets."""
SECRETS: Final = ("private_key_pem", "private_key_raw", "private_key_base64", "password")
"""Ends of the names of settings whose values are secrets."""


@dataclass(frozen=True, slots=True)
class ConfigFile:
    """The content of a file: settings by name; numbers are texts."""

    content: object

    def has(self, name: str) -> bool:
        """Return whether the file has a setting such as `connect/endpoints`."""
        found = self.content
        for part in name.split("/"):
            found = found.get(part) if isinstance(found, Mapping) else None
        return found is not None

    @property
    def holds_secrets(self) -> bool:
        """Whether a password or a private key is in the file itself."""
        return any(name.endswith(SECRETS) for name, _ in _texts("", self.content))

    @property
    def secret_files(self) -> tuple[Path, ...]:
        """The files with private keys and passwords that it names."""
        named = (Path(value) for name, value in _texts("", self.content) if name.endswith(FILES))
        return tuple(dict.fromkeys(named))


def read_config(path: Path) -> ConfigFile:
    """Return the content of a file in JSON5 or YAML; ValueError if it is neither."""
    text = path.read_text(encoding="utf-8")
    try:
        content = yaml.safe_load(text) if path.suffix in YAML else json.loads(_json(text))
    except (yaml.YAMLError, RecursionError) as error:
        raise ValueError(f"{path} cannot be read") from error
    return ConfigFile(content)


def _json(text: str) -> str:
    """Return JSON5 as JSON, its numbers as texts; ValueError if it is none."""
    found = [each for each in _tokens(text) if each.lastgroup != "space"]
    signs = [each[0] if each.lastgroup == "sign" else "" for each in found] + [""]
    parts = []
    for each, following in zip(found, signs[1:], strict=True):
        if each[0] == "," and following in {"}", "]"}:
            continue
        is_name = following == ":"
        if each.lastgroup == "text":
            parts.append(json.dumps(ESCAPE.sub(_character, each[0][1:-1])))
        elif each.lastgroup == "word" and (is_name or each[0] not in {"true", "false", "null"}):
            parts.append(json.dumps(each[0]))
        else:
            parts.append(each[0])
    return "".join(parts)


def _tokens(text: str) -> Iterator[re.Match[str]]:
    position = 0
    while position < len(text):
        token = TOKEN.match(text, position)
        if token is None:
            raise ValueError("a text has no end")
        yield token
        position = token.end()


def _character(escape: re.Match[str]) -> str:
    mark = escape[1]
    if len(mark) > 1 and mark[0] in "ux":
        return chr(int(mark[1:], 16))
    return ESCAPED.get(mark, mark)


def _texts(name: str, value: object) -> Iterator[tuple[str, str]]:
    """Yield the settings that are texts by name, options of endpoints (`tls/host#a=b`) too."""
    if isinstance(value, Mapping):
        for key, each in value.items():
            yield from _texts(str(key), each)
    elif isinstance(value, list):
        for each in value:
            yield from _texts(name, each)
    elif isinstance(value, str) and value:
        yield name, value
        for option in value.partition("#")[2].split(";"):
            key, _, text = option.partition("=")
            if text:
                yield key, text
