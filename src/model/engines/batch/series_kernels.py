"""Kernels that fill the series of runs, in every kind of mode, and sum them at the nodes.

Input: the code of series_code.py for every kind. Output: three kernels on the workspace, which
event_kernels.py adds to the kernels of a scene and step.py calls.
"""

from collections.abc import Sequence
from typing import Any

from model.compile.jit import kernel
from model.compile.source import defined
from model.compile.vector_code import VectorWriter, vector_function
from model.engines.batch.mode_kinds import ModeKind
from model.engines.batch.series import recurrences
from model.engines.batch.series_code import SeriesWriter
from model.engines.batch.series_layout import (
    FRACTIONS,
    NODES,
    ORDER,
    ROWS,
    SINES,
    STATE_ROWS,
    SUMMED_ORDERS,
    TILT,
    Layout,
)


class _SamplesWriter(VectorWriter):
    """Writes the function (coefficients, lengths, values) that sums series at the nodes.

    ``count`` is the number of event quantities.
    """

    def __init__(self, name: str, count: int) -> None:
        super().__init__(name, 3)
        self.coefficients, lengths, self.values = self.arguments
        self.length = self.load(lengths, 0)
        self.times = [self.do("fmul", self.length, self.vector(each)) for each in FRACTIONS]
        self.ratios = {  # of k (k - 1) h^k, from an order to the next
            order: self.do("fmul", self.length, self.vector((order + 1.0) / (order - 1.0)))
            for order in range(2, ORDER + 1)
        }
        self.repeat(str(STATE_ROWS), self._end_of_state)
        self.repeat(str(1 + count), self._one_row)

    def _coefficient(self, row: str, order: int) -> str:
        return self.load(self.base(self.coefficients, row), order * ROWS)

    def _enter(self, value: str, row: str, node: int) -> None:
        self.store(value, self.base(self.values, row), node * SINES)

    def _end_of_state(self, row: str) -> tuple[()]:
        """Sum a state at the last node: at other nodes states are not needed."""
        total = self.vector(0.0)
        for order in range(ORDER, -1, -1):
            total = self.fma(total, self.times[-1], self._coefficient(row, order))
        self._enter(total, row, NODES - 1)
        return ()

    def _one_row(self, index: str) -> tuple[()]:
        """Sum the tilt, or an event quantity, at all nodes, and bound its second derivative."""
        is_first = self.count("icmp eq", index, "0")
        other = self.count("add", index, str(STATE_ROWS - 1))
        row = self.result(f"select i1 {is_first}, i64 {TILT}, i64 {other}")
        sums, bound = [self.vector(0.0) for _ in FRACTIONS], self.vector(0.0)
        for order in range(ORDER, -1, -1):
            coefficient = self._coefficient(row, order)
            for node, last in enumerate(SUMMED_ORDERS):
                if order <= last:
                    sums[node] = self.fma(sums[node], self.times[node], coefficient)
            if order > 1:
                bound = self.fma(bound, self.ratios[order], self.call("fabs", coefficient))
        square = self.do("fmul", self.length, self.length)
        bound = self.do("fmul", bound, self.do("fmul", self.vector(2.0), square))
        for node, value in enumerate((coefficient, *sums, bound)):
            self._enter(value, row, node)
        return ()


def filler(name: str, writer: type[SeriesWriter], kinds: Sequence[ModeKind], inserts: bool) -> Any:
    """Make the kernel ``name`` (kind, block, *places) that calls the function written for a kind.

    ``kind`` is an index of ``kinds``; ``inserts`` as in ``recurrences``. ``block`` holds vectors,
    aligned to cache lines; the ``places`` in it are the arguments of the function of ``writer``.
    """

    def written(kind: ModeKind) -> Any:
        def write(label: str) -> VectorWriter:
            return writer(label, Layout(recurrences(kind, inserts)))

        return vector_function("_".join(map(str, (name, inserts, *kind))), write)

    known, lines = {}, [f"def {name}(kind, block, {writer.places}):"]
    for number, kind in enumerate(kinds):
        known[f"series_{number}"] = written(kind)
        lines.append(f"    if kind == {number}: series_{number}(block, ({writer.places}))")
    return kernel(defined(name, "\n".join(lines), known, f"{len(kinds)}_kinds"))


def series_sampler(count: int) -> Any:
    """Make the kernel (block, coefficients, lengths, values) that sums series at nodes of steps.

    It sums the tilt and the first ``count`` event quantities at the nodes of steps of the given
    ``lengths``; the other states at the last node only. At ``values`` stand SINES vectors for each
    node, then as many bounds of the second derivative with respect to the fraction of the step.
    """
    sample = vector_function(f"sample_{count}", lambda name: _SamplesWriter(name, count))
    code = (
        "def sample_series(block, coefficients, lengths, values):\n"
        "    sample(block, (coefficients, lengths, values))"
    )
    return kernel(defined("sample_series", code, {"sample": sample}, f"{count}_quantities"))
