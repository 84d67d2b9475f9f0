"""Independent solutions that are kept, by a hash of what is solved and of the code that solves it.

A solution takes up to some seconds, and is the same in every build. ``python -m
verification.bench.store`` solves the cases of the study anew, after an edit of a case or of the
solver, and writes stored.csv; what is not in it is solved when it is asked for.
"""

import ast
import csv
import dataclasses
import hashlib
from functools import cache
from pathlib import Path

import numpy as np

from model.physics.parameters import Parameters
from study.outline import outline
from verification.independent.solution import Solution, solve

TABLE = Path(__file__).with_suffix(".csv")


def key_of(parameters: Parameters, horizon: float) -> str:
    """Return the hash of a case: 16 hexadecimal digits.

    A parameter at its default is left out, so that a new one changes no hash.
    """
    stated = {
        field.name: getattr(parameters, field.name)
        for field in dataclasses.fields(parameters)
        if getattr(parameters, field.name) != field.default
    }
    asked = f"{sorted(stated.items())} {horizon!r} {_code()}"
    return hashlib.sha256(asked.encode()).hexdigest()[:16]


@cache
def _code() -> str:
    """Return the code of this folder but this file."""
    sources = sorted({*TABLE.parent.glob("*.py")} - {Path(__file__)})
    return repr([outline(ast.parse(each.read_text(encoding="utf-8")), []) for each in sources])


@cache
def _stored() -> dict[str, Solution]:
    with TABLE.open(newline="", encoding="utf-8") as file:
        return {
            key: Solution(ending, float(time), float(tau), (), np.array(state, dtype=float))
            for key, ending, time, tau, *state in list(csv.reader(file))[1:]
        }


def solution_of(parameters: Parameters, horizon: float) -> Solution:
    """Return the solution of a case as ``solve`` does, from the table if it is there.

    A solution from the table has no list of events.
    """
    found = _stored().get(key_of(parameters, horizon))
    return solve(parameters, horizon) if found is None else found
