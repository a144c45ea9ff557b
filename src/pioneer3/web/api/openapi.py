"""The OpenAPI document, from the operations."""

from collections.abc import Sequence
from http import HTTPStatus
from types import NoneType
from typing import Any

import msgspec

from pioneer3 import __version__
from pioneer3.web.access.role import Role
from pioneer3.web.api.operation import Operation
from pioneer3.web.problem import MEDIA_TYPE, Problem

WHO = {
    None: "For everybody.",
    Role.VIEWER: "For everybody who is in.",
    Role.DRIVER: "For drivers.",
}


def openapi(operations: Sequence[Operation]) -> dict[str, Any]:
    """Return the document that describes `operations` (OpenAPI 3.1)."""
    kinds = [kind for one in operations for kind in (one.body, one.answer) if _is_told(kind)]
    schemas, components = msgspec.json.schema_components(
        [*kinds, Problem], ref_template="#/components/schemas/{name}"
    )
    refs = iter(schemas)
    paths: dict[str, dict[str, Any]] = {}
    for one in operations:
        described = _describe(one)
        if _is_told(one.body):
            described["requestBody"] = {"required": True, "content": _content(next(refs))}
        success: dict[str, Any] = {"description": "Done."}
        if _is_told(one.answer):
            success["content"] = _content(next(refs))
        described["responses"] = {"200" if "content" in success else "204": success}
        described["responses"].update(_problems(one, schemas[-1]))
        paths.setdefault(one.path, {})[one.method.lower()] = described
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "pioneer3",
            "version": __version__,
            "description": "Drive a Pioneer 3. SI units, angles counter-clockwise.",
        },
        "paths": paths,
        "components": {
            "schemas": components,
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer"}},
        },
    }


def _is_told(kind: object) -> bool:
    return kind not in {None, NoneType}


def _content(schema: dict[str, Any], media_type: str = "application/json") -> dict[str, Any]:
    return {media_type: {"schema": schema}}


def _problems(one: Operation, schema: dict[str, Any]) -> dict[str, Any]:
    return {
        str(status): {
            "description": HTTPStatus(status).phrase,
            "content": _content(schema, MEDIA_TYPE),
        }
        for status in one.problems
    }


def _describe(one: Operation) -> dict[str, Any]:
    summary, rest = one.text
    return {
        "operationId": one.name,
        "summary": summary,
        "description": f"{rest}\n\n{WHO[one.needs]}".strip(),
        "tags": [one.path.split("/")[2]],
        "security": [{"token": []}] if one.needs else [],
        "parameters": [
            {
                "name": name,
                "in": "path",
                "required": True,
                "schema": {"type": "integer"} if name == "robot" else {"type": "string"},
            }
            for name in one.parameters
        ],
    }
