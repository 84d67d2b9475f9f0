"""Functions that fill the series of lanes, in every kind of mode, and sum them at the nodes.

Input: the code of series_code.py for every kind. Output: kernels on the workspace, which step.py
calls, and ``Series``, which compiles their functions.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from model.compile.entries import address_of
from model.compile.kernels import inlined_kernel
from model.compile.vector_code import VectorFunction, VectorWriter, call_at
from model.engine.mode_kinds import ModeKind
from model.engine.series import recurrences
from model.engine.series_code import ErrorWriter, SeriesWriter
from model.engine.series_layout import (
    FRACTIONS,
    LINES,
    NODES,
    ORDER,
    SINES,
    STATE_LINES,
    SUMMED_ORDERS,
    TILT,
    Layout,
)
from model.engine.workspace import (
    COEFFICIENTS,
    ERROR,
    FILLED_ORDER,
    LAST_ORDER,
    STEP_LENGTH,
    VALUES,
)
from model.physics.parameters import Constants


class _SamplesWriter(VectorWriter):
    """Writes the function (coefficients, lengths, values) that sums series at the nodes.

    It sums the tilt and the first ``count`` event quantities at the nodes of steps of the given
    ``lengths``; the other states at the last node only. At ``values`` stand SINES vectors for each
    node, then as many bounds of the second derivative with respect to the fraction of the step.
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
        self.repeat(str(STATE_LINES), self._end_of_state)
        self.repeat(str(1 + count), self._one_line)

    def _coefficient(self, line: str, order: int) -> str:
        return self.load(self.base(self.coefficients, line), order * LINES)

    def _enter(self, value: str, line: str, node: int) -> None:
        self.store(value, self.base(self.values, line), node * SINES)

    def _end_of_state(self, line: str) -> tuple[()]:
        """Sum a state at the last node: at other nodes states are not needed."""
        total = self.vector(0.0)
        for order in range(ORDER, -1, -1):
            total = self.fma(total, self.times[-1], self._coefficient(line, order))
        self._enter(total, line, NODES - 1)
        return ()

    def _one_line(self, index: str) -> tuple[()]:
        """Sum the tilt, or an event quantity, at all nodes, and bound its second derivative."""
        is_first = self.count("icmp eq", index, "0")
        other = self.count("add", index, str(STATE_LINES - 1))
        line = self.result(f"select i1 {is_first}, i64 {TILT}, i64 {other}")
        sums, bound = [self.vector(0.0) for _ in FRACTIONS], self.vector(0.0)
        for order in range(ORDER, -1, -1):
            coefficient = self._coefficient(line, order)
            for node, last in enumerate(SUMMED_ORDERS):
                if order <= last:
                    sums[node] = self.fma(sums[node], self.times[node], coefficient)
            if order > 1:
                bound = self.fma(bound, self.ratios[order], self.call("fabs", coefficient))
        square = self.do("fmul", self.length, self.length)
        bound = self.do("fmul", bound, self.do("fmul", self.vector(2.0), square))
        for node, value in enumerate((coefficient, *sums, bound)):
            self._enter(value, line, node)
        return ()


class Series:
    """Functions of vectors that fill and sample the series of every kind of mode.

    A function is compiled or loaded when the first run enters a mode of its kind.

    Args:
        kinds: kinds of modes, in the order of their numbers.
        inserts, constants, switches: as in ``recurrences``.
        count: number of event quantities.
        is_resident: True where the functions are part of the code that calls them: in a page.

    Attributes:
        fill: functions (coefficients, given, last) of ``SeriesWriter``.
        fill_errors: functions (errors, given, coefficients, last) of ``ErrorWriter``.
        count: number of event quantities that are sampled.
        sample: function of ``_SamplesWriter``.
        addresses: of ``fill``, then of ``fill_errors``; 0 for those that are not loaded.
    """

    def __init__(
        self,
        kinds: Sequence[ModeKind],
        inserts: bool,
        constants: type[Constants],
        switches: tuple[float, ...],
        count: int,
        is_resident: bool = False,
    ) -> None:
        self.is_resident, self._arguments = (
            is_resident,
            ((kinds, inserts, constants, switches, count)),
        )
        self.count = count
        self.fill = _written("fill_series", SeriesWriter, *self._arguments[:4])
        self.fill_errors = _written("fill_errors", ErrorWriter, *self._arguments[:4])
        self.sample = VectorFunction(
            f"sample_series_{count}", lambda name: _SamplesWriter(name, count)
        )  # fmt: skip
        self.addresses = np.zeros(2 * len(kinds), np.int64)

    @property
    def identity(self) -> Any:
        """Return what it is made of, for the cache."""
        return *self._arguments, self.is_resident

    def load(self, number: int) -> None:
        """Load a function: compile it, unless it is stored, and write its address."""
        self.addresses[number] = address_of((*self.fill, *self.fill_errors)[number])


def _written(
    name: str,
    writer: type[SeriesWriter],
    kinds: Sequence[ModeKind],
    inserts: bool,
    constants: type[Constants],
    switches: tuple[float, ...],
) -> tuple[VectorFunction, ...]:
    """Return the function that a writer writes for each kind of mode."""

    def of(kind: ModeKind) -> VectorFunction:
        def write(label: str) -> VectorWriter:
            return writer(label, Layout(recurrences(kind, inserts, constants, switches)))

        printed = map(int, switches if any(switches) else ())
        numbers = int(inserts), int(constants.is_round), *kind, *printed
        return VectorFunction("_".join(map(str, (name, *numbers))), write)

    return tuple(map(of, kinds))


# ------------------------------------------------------------------------------------------ kernels


@inlined_kernel
def missing_series(lanes, kind, carries_error, addresses):
    """Return the number of a function that lanes need and that is not loaded; -1 if none is."""
    if not lanes.series.is_resident:
        if addresses[kind] == 0:
            return kind
        if carries_error and addresses[len(lanes.series.fill) + kind] == 0:
            return len(lanes.series.fill) + kind
    return -1


@inlined_kernel
def fill_series(lanes, kind, addresses, w):
    """Fill the series of lanes in a kind of mode."""
    lines = COEFFICIENTS, 0, LAST_ORDER
    if lanes.series.is_resident:
        for number, fill in enumerate(lanes.series.fill):
            if kind == number:
                fill(w, lines)
    else:
        call_at(addresses[kind], w, lines)


@inlined_kernel
def fill_errors(lanes, kind, addresses, w):
    """Fill the series of the errors of lanes; runs of a page carry none."""
    if not lanes.series.is_resident:
        call_at(addresses[len(lanes.series.fill) + kind], w, (ERROR, 0, COEFFICIENTS, FILLED_ORDER))


@inlined_kernel
def sample_series(lanes, w):
    """Sum the tilt and the event quantities at the nodes of steps; see ``_SamplesWriter``."""
    lanes.series.sample(w, (COEFFICIENTS, STEP_LENGTH, VALUES))
