"""Make the JSON Schemas in `docs/schemas` from the types of the JSON files: ``python docs/make_schemas.py``.

What a key is comes from the text below it in `elbowscrew.model.*_summary_types`; no other keys are allowed.
"""

from __future__ import annotations

import ast
import inspect
import itertools
import json
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from elbowscrew.declaring import option_name
from elbowscrew.model import comparison_summary_types, joint_summary_types, summary_types
from elbowscrew.settings import Settings

FOLDER = Path(__file__).with_name("schemas")
FILES: dict[str, Any] = {
    "summary": summary_types.Summary,
    "joint": joint_summary_types.JointSummary,
    "compare": comparison_summary_types.ComparisonSummary | comparison_summary_types.TrialsSummary,
    "info": summary_types.FileSummary,
}
"""Each file by its name, and its type."""

_MODULES = (joint_summary_types, summary_types, comparison_summary_types)  # bases first
_BOUNDS = {"ge": "minimum", "gt": "exclusiveMinimum", "le": "maximum", "lt": "exclusiveMaximum"}
_WIDTH = 110


def schema(name: str) -> dict[str, Any]:
    """Give the schema of a file, as ``summary`` for ``summary.json``."""
    made = TypeAdapter(FILES[name]).json_schema()
    texts = _texts()
    for definition in (*made.get("$defs", {}).values(), made):
        if "properties" not in definition:
            continue
        definition["additionalProperties"] = False
        kind = definition.pop("title")
        for key, value in definition["properties"].items():
            value.pop("title", None)
            if key == "settings":
                value.clear()
                value.update(_settings())
            if key in texts[kind]:
                value["description"] = texts[kind][key]
    made = _plain(made)
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": f"{name}.json of elbowscrew"}
    return {**head, **made}


def _settings() -> dict[str, Any]:
    """Every setting by the name of its option, as `elbowscrew.results.summary.settings_summary` gives it."""
    properties = {}
    made = Settings.model_json_schema(mode="serialization")
    for field, value in _whole(made["properties"], made.get("$defs", {})).items():
        for key in ("about", "default", "metavar", "shown", "title"):
            value.pop(key, None)
        if field in ("method", "law"):  # a summary has what the default comes to
            value["anyOf"] = [one for one in value["anyOf"] if one != {"type": "null"}]
        properties[option_name(field)] = value
    return {"type": "object", "properties": properties, "required": list(properties), "additionalProperties": False}


def _whole(part: Any, definitions: dict[str, Any]) -> Any:
    """Put each definition in the place where it is named, without the words that speak to programmers."""
    match part:
        case {"$ref": str(place)}:
            made = {key: value for key, value in definitions[place.rpartition("/")[2]].items() if key != "description"}
            return {**_whole(made, definitions), "additionalProperties": False}
        case dict():
            return {key: _whole(value, definitions) for key, value in part.items() if not _is_word(key, value)}
        case list():
            return [_whole(value, definitions) for value in part]
    return part


def _is_word(key: str, value: Any) -> bool:
    return key == "title" and isinstance(value, str)


def _texts() -> dict[str, dict[str, str]]:
    """Collect the text below each key of each class, those of its bases among them."""
    texts: dict[str, dict[str, str]] = {}
    for module in _MODULES:
        for node in ast.parse(inspect.getsource(module)).body:
            match node:
                case ast.ClassDef(name=name, bases=bases, body=body):
                    of_bases = [texts.get(base.id, {}) for base in bases if isinstance(base, ast.Name)]
                    texts[name] = {key: text for base in of_bases for key, text in base.items()} | _below(body)
                case ast.Assign(targets=[ast.Name(id=name)]):
                    texts[name] = {}
    return texts


def _below(body: list[ast.stmt]) -> dict[str, str]:
    found = {}
    for pair in itertools.pairwise(body):
        match pair:
            case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(words))):
                found[name] = " ".join(words.split())
    return found


def _plain(value: Any) -> Any:
    """Write a schema as short as it can be, and the same whichever version of pydantic made it."""
    if isinstance(value, list):
        return [_plain(one) for one in value]
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if not isinstance(value, dict):
        return value
    plain = {_BOUNDS.get(key, key): _plain(one) for key, one in value.items()}
    if "const" in plain:
        plain.pop("enum", None)
    match plain.get("anyOf"):
        case [one]:
            plain = {**{key: said for key, said in plain.items() if key != "anyOf"}, **one}
        case [{"type": str(kind)} as one, {"type": "null"}] if len(one) == 1:
            plain = {**{key: said for key, said in plain.items() if key != "anyOf"}, "type": [kind, "null"]}
    return dict(sorted(plain.items())) if "type" in plain and "properties" not in plain else plain


def text(name: str) -> str:
    """Text of the schema of a file."""
    return _lines(schema(name), "") + "\n"


def _lines(value: Any, indent: str) -> str:
    """Write JSON on as few lines as fit."""
    line = json.dumps(value, ensure_ascii=False)
    if len(indent) + len(line) <= _WIDTH or not isinstance(value, dict | list):
        return line
    inside = indent + " "
    if isinstance(value, list):
        return "[\n" + ",\n".join(inside + _lines(one, inside) for one in value) + f"\n{indent}]"
    parts = (f"{inside}{json.dumps(key)}: {_lines(one, inside)}" for key, one in value.items())
    return "{\n" + ",\n".join(parts) + f"\n{indent}}}"


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for file in FILES:
        (FOLDER / f"{file}.schema.json").write_text(text(file), encoding="utf-8")
