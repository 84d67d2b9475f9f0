"""Directive `generated`: pages of the reference, made from the code that they describe."""

import argparse
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from model.engine.results import IN_SLOT, RESULTS, TRACK_VARIABLES, UNVIBRATED_CONTROL, Result
from model.events.outcomes import OUTCOME_TEXT, REASON_TEXT, Outcome, Reason, remedy
from model.events.table import EVENTS
from model.physics.parameters import FIELDS, Parameters
from model.physics.units import UNITS
from model.sweeps.io import unit_in_file
from study import __main__ as of_study
from verification.bench.report.checks import CHECKS, HEAD, SPEED_HEAD, SPEEDS
from vibralign.commands import main as of_tool


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table in Markdown."""
    lines = [list(head)]
    lines += [["---"] * len(lines[0]), *(list(row) for row in rows)]
    return "\n".join("| " + " | ".join(row) + " |" for row in lines) + "\n"


def _parameters() -> str:
    defaults = {name: getattr(Parameters, name, "required") for name in FIELDS}
    rows = (
        (
            f"`{name}`",
            field.symbol,
            field.quantity.unit,
            field.description,
            field.rule.removeprefix("must be "),
            "derived" if defaults[name] is None else str(defaults[name]),
        )
        for name, field in FIELDS.items()
    )
    head = ("name", "symbol", "SI unit", "meaning", "rule", "default in Python")
    return _table(head, rows)


def _units() -> str:
    rows = ((f"`{name}`", each.quantity.unit, each.description) for name, each in UNITS.items())
    return _table(("name", "SI unit", "meaning"), rows)


def _outcomes() -> str:
    rows = (
        (f"`{each.name.lower()}`", str(each.value), OUTCOME_TEXT[each], remedy(each, Reason.NONE))
        for each in Outcome
    )
    return _table(("outcome", "flag", "meaning", "remedy"), rows)


def _reasons() -> str:
    rows = (
        (f"`{each.name.lower()}`", str(each.value), REASON_TEXT[each])
        for each in Reason
        if each is not Reason.NONE
    )
    return _table(("reason", "flag", "meaning"), rows)


def _says(kernel: Any) -> str:
    """Return the summary of a kernel's docstring."""
    text = getattr(kernel, "py_func", kernel).__doc__ or ""
    return " ".join(text.partition("\n\n")[0].split())


def _events() -> str:
    rows = (
        (
            f"`{event.name}`",
            " ".join(_says(function) for _, function in event.function),
            _says(event.transition),
        )
        for event in EVENTS
    )
    return _table(("event", "event function", "transition"), rows)


def _help_of(parser: argparse.ArgumentParser) -> str:
    """Return the help of a command without the table of parameters, which has its own page."""
    return parser.format_help().partition("parameters that --set takes")[0].strip()


def _commands() -> str:
    os.environ["COLUMNS"] = "84"
    pages: list[tuple[str, argparse.ArgumentParser]] = []
    for parser in (of_tool.parser(), of_study.parser()):
        [commands] = (
            action for action in parser._actions if isinstance(action, argparse._SubParsersAction)
        )
        pages += [(parser.prog, parser), *((each.prog, each) for each in commands.choices.values())]
    return "\n\n".join(f"## `{name}`\n\n```text\n{_help_of(page)}\n```" for name, page in pages)


def _variables_of(table: Mapping[str, Result]) -> str:
    rows = (
        (f"`{name}`", each.symbol or "", unit_in_file(each.quantity), each.explanation)
        for name, each in table.items()
        if each.stored
    )
    return _table(("variable", "symbol", "units", "meaning"), rows)


GENERATED: dict[str, Callable[[], str]] = {
    "checks": lambda: _table((name.removeprefix(">") for name in HEAD), CHECKS),
    "speeds": lambda: _table((name.removeprefix(">") for name in SPEED_HEAD), SPEEDS),
    "commands": _commands,
    "events": _events,
    "outcomes": _outcomes,
    "parameters": _parameters,
    "reasons": _reasons,
    "units": _units,
    "variables": lambda: _variables_of({**RESULTS, **UNVIBRATED_CONTROL, **IN_SLOT}),
    "histories": lambda: _variables_of(TRACK_VARIABLES),
}


class Generated(SphinxDirective):
    """Insert one of ``GENERATED``, named by the argument."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the parsed Markdown."""
        text = GENERATED[self.arguments[0]]()
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def _bars_are_text(*event: Any) -> None:
    """Keep |x| in docstrings as it is: reST would take it for a substitution."""
    lines = event[-1]
    lines[:] = [line if "``" in line else line.replace("|", "\\|") for line in lines]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("generated", Generated)
    app.connect("autodoc-process-docstring", _bars_are_text)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
