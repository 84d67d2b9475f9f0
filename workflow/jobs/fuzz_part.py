"""Try every property on some of the random sets of `make fuzz`."""

from pathlib import Path
from typing import Any

from model.tracking.provenance import write_text
from verification.fuzz_campaign import report_text, try_part


def run(scene: str, seed: int, first: int, count: int, found: Path) -> dict[str, Any]:
    """Write the report on ``count`` sets from number ``first`` on."""
    report = try_part(scene, seed, first, count)
    write_text(report_text(report), found)
    return {"counts": {"trajectories": count, "sensitive": report.sensitive}}
