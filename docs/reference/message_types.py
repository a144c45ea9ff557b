"""Write the types of the page's WebSocket messages from the classes of the package.

    uv run docs/reference/message_types.py

It writes a JSON Schema for programs, and TypeScript declarations for the comments in the page's
JavaScript, which editors read; they are no part of the repository.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

import msgspec

from pioneer3.web import messages, requests

ROOT = Path(__file__).parents[2]
SCHEMA = ROOT / "docs/reference/websocket.schema.json"
DECLARATIONS = ROOT / "src/pioneer3/web/static/messages.d.ts"
PREFIX = "#/$defs/"
TO_SERVER: tuple[type, ...] = get_args(requests.AnyRequest)
SCALARS = {"integer": "number", "number": "number", "string": "string", "boolean": "boolean"}

Schema = dict[str, Any]


def definitions() -> dict[str, Schema]:
    """Return the JSON Schema of each message and of each of its parts, by name."""
    to_page = _components(messages.EVERY)
    for schema in to_page.values():  # the server leaves out nothing
        if "properties" in schema:
            schema["required"] = list(schema["properties"])
        for field in schema.get("properties", {}).values():
            field.pop("default", None)
    return {**to_page, **_components(TO_SERVER)}


def schema() -> str:
    """Return the JSON Schema of all messages."""
    document = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Messages of pioneer3's WebSocket, /ws",
        "description": "SI units, angles counter-clockwise. Regenerate: message_types.py.",
        "$defs": {
            **definitions(),
            "ToPage": {"anyOf": [_reference(kind) for kind in messages.EVERY]},
            "ToServer": {"anyOf": [_reference(kind) for kind in TO_SERVER]},
        },
        "anyOf": [{"$ref": f"{PREFIX}ToPage"}, {"$ref": f"{PREFIX}ToServer"}],
    }
    return json.dumps(document, indent=1) + "\n"


def declarations() -> str:
    """Return the TypeScript declarations of all messages."""
    blocks = [_declaration(name, schema) for name, schema in definitions().items()]
    for name, kinds in (("ToPage", messages.EVERY), ("ToServer", TO_SERVER)):
        blocks.append(f"export type {name} = {' | '.join(kind.__name__ for kind in kinds)};\n")
    head = "// Made by docs/reference/message_types.py from pioneer3.web.messages and requests.\n"
    return "\n".join([head, *blocks])


def _components(kinds: Sequence[type]) -> dict[str, Schema]:
    _, found = msgspec.json.schema_components(kinds, ref_template=f"{PREFIX}{{name}}")
    for kind, schema in found.items():
        assert "." not in kind, f"{kind}: two classes have this name"
        if "description" in schema:
            schema["description"] = _summary(schema["description"])
    return found


def _summary(text: str) -> str:
    return " ".join(text.partition("Attributes:")[0].split())


def _reference(kind: type) -> Schema:
    return {"$ref": f"{PREFIX}{kind.__name__}"}


def _declaration(name: str, schema: Schema) -> str:
    comment = f"/** {schema['description']} */\n" if "description" in schema else ""
    if "properties" not in schema:
        return f"{comment}export type {name} = {_type(schema)};\n"
    required = schema.get("required", ())
    fields = "".join(
        f"  {field}{'' if field in required else '?'}: {_type(kind)};\n"
        for field, kind in schema["properties"].items()
    )
    return f"{comment}export interface {name} {{\n{fields}}}\n"


def _type(schema: Mapping[str, Any]) -> str:
    """Return the TypeScript type of a schema."""
    if "$ref" in schema:
        return str(schema["$ref"]).removeprefix(PREFIX)
    if "anyOf" in schema:
        return " | ".join(map(_type, schema["anyOf"]))
    if "enum" in schema:
        return " | ".join(map(json.dumps, schema["enum"]))
    if "prefixItems" in schema:
        return f"[{', '.join(map(_type, schema['prefixItems']))}]"
    if schema["type"] == "array":
        item = _type(schema["items"])
        return f"({item})[]" if " | " in item else f"{item}[]"
    return SCALARS.get(schema["type"], str(schema["type"]))


if __name__ == "__main__":
    SCHEMA.write_text(schema(), encoding="utf-8")
    DECLARATIONS.write_text(declarations(), encoding="utf-8")
