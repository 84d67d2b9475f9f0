"""JSON schemas of the configuration, for completion and checks in editors: ``make schema``.

``study.json`` describes config.yaml and the sections beside it, each of which states some of the
keys at the top. ``overlay.json`` describes files laid over them, such as smoke.yaml: no key is
required.
"""

import json
import sys
from collections.abc import Collection
from pathlib import Path
from typing import Any

from model.study.config.base import PARAMETER_NAME
from model.study.config.study import Study

_REQUIRING = ("required", "discriminator", "minProperties")


def _without(schema: Any, dropped: Collection[str]) -> Any:
    """Return a schema without some of its keywords, and with the parameters' names stated once."""
    if isinstance(schema, list):
        return [_without(each, dropped) for each in schema]
    if not isinstance(schema, dict):
        return schema
    kept = {
        name: {key: _without(each, dropped) for key, each in value.items()}
        if name in ("properties", "$defs")  # whose keys are names and no keywords
        else _without(value, dropped)
        for name, value in schema.items()
        if name not in dropped
    }
    if kept.items() >= PARAMETER_NAME.items():
        rest = {key: each for key, each in kept.items() if key not in PARAMETER_NAME}
        return {"$ref": "#/$defs/ParameterName", **rest}
    return kept


def schemas() -> dict[str, str]:
    """Return the text of each schema by the name of its file."""
    study = _without(Study.model_json_schema(), ["title"])
    study["$defs"]["ParameterName"] = PARAMETER_NAME
    study.pop("required")
    # Without required keys a figure may be of several kinds: any of them that has its keys.
    overlay = json.loads(json.dumps(_without(study, _REQUIRING)).replace('"oneOf"', '"anyOf"'))
    overlay["$defs"]["ParameterName"] = PARAMETER_NAME
    named = {"study": study, "overlay": overlay}
    return {
        f"{name}.json": json.dumps(each, indent=1, ensure_ascii=False) + "\n"
        for name, each in named.items()
    }


def main() -> None:
    """Write the schemas into the folder that the command line names."""
    for name, text in schemas().items():
        (Path(sys.argv[1]) / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
