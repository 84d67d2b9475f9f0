"""Constructs outside of the subset and mistakes are refused in words: one for each place that refuses."""

# ruff: noqa: E501 - a line is a case

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from model.compile.entries import compiled
from model.compile.source import KernelError
from tests.model.compile.sources import kernel_of

FLOATS, INTS = np.zeros(4), np.zeros(4, np.int64)
ROWS = np.zeros((3, 2))

# what: (parameters, body, arguments, words of the problem, words of the remedy); the line of the
# body that is wrong ends with the comment "here"
STATEMENTS = {
    "try": ("try:  # here\n    x = 1\nexcept ValueError:\n    pass", "`try:`", "test before"),
    "with": ("with open('a') as f:  # here\n    pass", "`with open('a') as f:`", "caller"),
    "global": ("global FOUND  # here\nFOUND = x", "`global FOUND`", "return"),
    "for else": ("for i in range(3):  # here\n    pass\nelse:\n    x = 1", "`else` of a loop", "if after"),
    "for each else": ("for i in (1, 2):  # here\n    pass\nelse:\n    x = 1", "`else` of a loop", "if after"),
    "walrus": ("if (y := x) > 1:  # here\n    pass", "`(y := x)`", "assign before"),
    "lambda": ("f = lambda y: y  # here\nreturn f(x)", "`lambda y: y`", "a kernel"),
    "f-string": ("y = f'{x}'  # here", "f'{x}'", "text"),
    "an ellipsis of a long expression": (f"y = [{', '.join(['x'] * 40)}]  # here", "a node of Python's syntax", "tuple"),
    "a starred target": ("a, *b = x, 1, 2  # here", "3 values for 2 names", "each name"),
    "a target that is a member": ("p = Point(x, 1)\np.x = 2.0  # here", "to a member", "_replace"),
    "a target that is a tuple": ("t = (x, 1)\nt[0] = 2.0  # here", "into a tuple of a float, an int", "arrays"),
    "matrices": ("y = x @ x  # here", "MatMult", "sums"),
}  # fmt: skip

MISTAKES = {
    # --------------------------------------------------------------------------------------- names
    "an unknown name": ("x", "y = x + z  # here", (1.0,), "'z' is not defined", "define or import"),
    "a name of one branch": ("x", "if x > 0:\n    y = 1\nreturn y  # here", (1.0,), "'y' is not assigned on every way", "before the branch"),
    "a name of a loop": ("n", "for i in range(n):\n    y = i\nreturn y  # here", (3,), "'y' is not assigned on every way", "before"),
    "a cell that is empty": ("x", "return LATER(x)", (1.0,), "not associated|empty|free variable", "pass"),
    "a number here, a tuple there": ("x", "if x > 0:\n    y = 1\nelse:\n    y = (1, 2)\nreturn y  # here", (1.0,), "'y' is an int here and a tuple of an int, an int there", "one type"),
    "an int here, a float there": ("x", "if x > 0:\n    y = 1\nelse:\n    y = 2.0\nreturn y  # here", (1.0,), "'y' is an int here and a float there", "one type"),
    "an int that becomes a float": ("n", "y = 0\nfor i in range(n):  # here\n    y += 0.5\nreturn y", (3,), "'y' is an int before a round of the loop and a float after it", "one type"),
    "a choice of an int and a float": ("x", "return x if x > 0 else 0  # here", (1.0,), "a value that is a float or an int", "0.0, not 0"),
    "an item of several types": ("n", "return (1, 2.0)[n]  # here", (1,), "a value that is an int or a float", "same type"),
    "results that are an int and a float": ("x", "if x > 0:\n    return x\nreturn 0  # here", (1.0,), "returns a float and an int", "one type"),
    "other named tuples": ("x", "p = Point(x, 1, True) if x > 0 else Triple(x, 1, 2)  # here", (1.0,), "a tuple Point of a float, an int, a bool or a tuple Triple of", "same type"),
    "a loop that changes a type": ("n", "y = 0\nfor i in range(n):  # here\n    y = (y, 1)\nreturn n", (3,), "'y' is an int before a round of the loop and a tuple of an int, an int after it", "one type"),
    "a result and none": ("x", "if x > 0:\n    return x", (1.0,), "returns a float and the object None", "one type"),
    "an int that does not fit": ("x", "return x + 9223372036854775808 * 1  # here", (1.0,), "9223372036854775808 does not fit", "float"),
    # -------------------------------------------------------------------------------------- values
    "a float as an index": ("w, x", "return w[x]  # here", (FLOATS, 1.0), "a float as an index", "int("),
    "a float as an index of a tuple": ("x", "return (1, 2)[x]  # here", (1.0,), "a float as an index", "int("),
    "None as an index": ("w", "return w[None][0]  # here", (FLOATS,), "must be a number", "pass"),
    "an index from the end": ("w", "return w[-1]  # here", (FLOATS,), "the index -1 of an array", "from the beginning"),
    "an index from the end, by a name": ("w", "i = -1\nreturn w[i]  # here", (FLOATS,), "the index -1", "beginning"),
    "an index that cannot be": ("w", "return w[0, 2]  # here", (ROWS,), "the index 2 of 2", "exists"),
    "an index of a tuple that cannot be": ("x", "return (x, 1)[2]  # here", (1.0,), "the index 2 of 2", "exists"),
    "an index of a table that cannot be": ("x", "return TABLE[5]  # here", (1.0,), "index out of range", "pass"),
    "a key at run time": ("n", "return NAMED[n]  # here", (1,), "such an index of", "tuple"),
    "too many indices": ("w", "return w[0, 1, 0]  # here", (ROWS,), "3 indices of an array of 2", "at most"),
    "two indices of a tuple": ("x", "return (x, 1)[0, 1]  # here", (1.0,), "2 indices of a tuple", "one"),
    "a number with an index": ("x", "return x[0]  # here", (1.0,), "the items of a float", "tuple"),
    "a slice with a step": ("w", "return w[::2][0]  # here", (FLOATS,), "a slice with a step", "range"),
    "a slice of a tuple at run time": ("n", "return (1, 2, 3)[n:]  # here", (1,), "such a slice", "known"),
    "an array as a number": ("w", "return w + 1  # here", (FLOATS,), "must be a number, and is an array of 1", "pass"),
    "an array as a condition": ("w", "if w:  # here\n    return 1\nreturn 2", (FLOATS,), "must be a number", "pass"),
    "an array in a comparison": ("w", "return w == 1.0  # here", (FLOATS,), "must be a number", "pass"),
    "arithmetic on a part": ("w", "w[0:2] += 1.0  # here", (FLOATS,), "a part of an array", "loop"),
    "writing a constant array": ("x", "ARRAY[0] = x  # here", (1.0,), "into the object", "arrays"),
    "counting in a constant array": ("x", "return fetch_add(COUNTS[0:1], 1)  # here", (1.0,), "fetch_add to an array", "run time"),
    "counting by a float": ("k", "return fetch_add(k, 0.5)  # here", (INTS,), "a float as a count", "int("),
    "an array of other numbers": ("x", "return SMALL[0] + x  # here", (1.0,), "float32", "float64 or int64"),
    "a sum of tuples and numbers": ("x", "return (x, 1) + x  # here", (1.0,), "arithmetic on tuples", "item by item"),
    "a comparison of tuples": ("x", "return (x, 1) == (1, x)  # here", (1.0,), "comparison of tuples", "item by item"),
    "a tuple among tuples": ("x", "return (x, 1) in ((1, 2), (3, 4))  # here", (1.0,), "comparison of tuples", "item by item"),
    "an order of text and numbers": ("x", "return 'a' < 1  # here", (1.0,), "not supported", "pass"),
    "is of numbers": ("x", "return x is 1.0  # here", (1.0,), "`is` without None", "write =="),
    "and of numbers": ("x, n", "return x and n  # here", (1.0, 2), "what is no bool", "compare"),
    "// of a float": ("x", "return x // 2  # here", (1.0,), "// or % of a float", "floor(a / b)"),
    "a known division by 0": ("x", "return x + 1 / 0  # here", (1.0,), "division by zero", "pass"),
    "// by a known 0": ("n", "return n // 0  # here", (1,), "division by 0", "another"),
    "a power of two ints": ("n, m", "return n ** m  # here", (1, 2), "a power of two ints", "float"),
    "bits of a float": ("x", "return x & 1  # here", (1.0,), "a float as an operand", "int("),
    "bits of a known float": ("x", "return ~1.5  # here", (1.0,), "bad operand", "pass"),
    "a long shift": ("n", "return n << 64  # here", (1,), "a shift by 64", "0 to 63"),
    # -------------------------------------------------------------------------------------- tuples
    "too many values": ("t", "a, b = t  # here", ((1, 2, 3),), "3 values for 2 names", "each name"),
    "values of a number": ("x", "a, b = x  # here", (1.0,), "the items of a float", "tuple"),
    "a field that does not exist": ("p", "return p.x + p.z  # here", ((1.0, 2),), "has no 'x'", "member"),
    "_replace of an unknown field": ("x", "return Point(x, 1)._replace(z=1)  # here", (1.0,), "_replace of z", "x, n, flag"),
    "_replace by position": ("x", "return Point(x, 1)._replace(1)  # here", (1.0,), "_replace with such arguments", "write"),
    "a named tuple with too few fields": ("x", "return Point(x)  # here", (1.0,), "missing a required argument: 'n'", "call Point"),
    "a class with a __new__": ("x", "return Odd(x)  # here", (1.0,), "a __new__ of its own", "kernel"),
    "an iterator that is kept": ("x", "t = (v for v in (x, 1))  # here\nreturn tuple(t)", (1.0,), "an iterator that is kept", "tuple(...)"),
    "a returned generator": ("x", "return (v for v in (x, 1))  # here", (1.0,), "an iterator that is kept", "tuple(...)"),
    "a loop over a generator": ("x", "for v in (x * n for n in (1, 2)):  # here\n    x = v\nreturn x", (1.0,), "a loop over an iterator", "tuple"),
    "a loop over a zip of a generator": ("x", "for v in zip((x * n for n in (1, 2)), (1, 2)):  # here\n    x = v[0]\nreturn x", (1.0,), "a loop over an iterator", "tuple"),
    "the length of a generator": ("x", "return len(v for v in (x, 1))  # here", (1.0,), "the length of an iterator", "tuple"),
    "an item of a generator": ("x", "return zip((x, 1), (1, 2))[0]  # here", (1.0,), "an iterator that is kept", "tuple"),
    "a generator at run time": ("n", "return tuple(v for v in range(n))  # here", (3,), "a range of run time", "for statement"),
    "items that are left out at run time": ("t", "return tuple(v for v in t if v > 1)  # here", ((1, 2),), "leaves out items at run time", "known"),
    "a loop over rows of any number": ("w", "for v in w:  # here\n    pass\nreturn 1", (ROWS,), "the items of an array", "range"),
    "a loop over too much": ("n", "for v in LONG:  # here\n    n += v\nreturn n", (3,), "1025 items to be unrolled", "range"),
    "a star of an array": ("w", "return max(*w)  # here", (FLOATS,), "the items of an array", "range"),
    "a zip of different lengths": ("t", "s = 0\nfor a, b in zip(t, (1, 2, 3)):  # here\n    s += a\nreturn s", ((1, 2),), "zip of 2, 3 items", "same number"),
    # --------------------------------------------------------------------------------------- loops
    "range of a float": ("x", "for i in range(x):  # here\n    pass", (3.0,), "a float as an end of a range", "int("),
    "range with a step of run time": ("n", "for i in range(0, 9, n):  # here\n    pass", (3,), "step is 0 or not known", "int"),
    "range of nothing": ("n", "for i in range():  # here\n    pass", (3,), "range of 0 values", "takes"),
    "range by names": ("n", "for i in range(stop=n):  # here\n    pass", (3,), "range with names", "position"),
    "range with another meaning": ("range", "s = 0\nfor i in range(3):  # here\n    s += i\nreturn s", (len,), "another meaning", "another name"),
    # --------------------------------------------------------------------------------------- calls
    "a function that is no kernel": ("x", "return plain(x)  # here", (1.0,), "'plain' is no kernel", "@kernel"),
    "a call of a number": ("x", "return x(1)  # here", (1.0,), "a call of a float", "kernel"),
    "a call of a string": ("x", "return 'a'(1)  # here", (1.0,), "'a'", "@kernel"),
    "too few arguments": ("x", "return scaled()  # here", (1.0,), "scaled: missing a required argument: 'x'", "call scaled(x, by=2.5)"),
    "arguments by **": ("x", "return scaled(x, **NAMED)  # here", (1.0,), "arguments by **", "one by one"),
    "a kernel with **": ("x", "return named(x, a=1)  # here", (1.0,), "takes **names", "parameters"),
    "a method": ("x", "return OBJECT.method(x)  # here", (1.0,), "the kernel <bound method", "outside of a class"),
    "a builtin with too few arguments": ("x", "return abs()  # here", (1.0,), "abs: missing", "takes"),
    "a builtin with names": ("x", "return max(x, 1.0, key=abs)  # here", (1.0,), "max with key", "position"),
    "min of nothing": ("x", "return min(())  # here", (1.0,), "the extreme of nothing", "a number"),
    "min of no argument": ("x", "return min()  # here", (1.0,), "min", "pass"),
    "min of a tuple and a number": ("x", "return min((x, 1), x)  # here", (1.0,), "must be a number, and is a tuple", "pass"),
    "isinstance of what is not known": ("x", "return isinstance(x, x)  # here", (1.0,), "class that is not known", "name the class"),
    "isinstance of no class": ("x", "return isinstance(x, 'a')  # here", (1.0,), "issubclass", "pass"),
    "getattr at run time": ("x, n", "return getattr(Point(x, n), n)  # here", (1.0, 2), "chosen at run time", "if"),
    "where of tuples": ("b", "return np.where(b, (1, 2), (3, 4))  # here", (True,), "must be a number", "pass"),
    "recursion": ("n", "return recursive(n)", (3,), "recursive calls itself", "loop"),
    "recursion by another": ("n", "return ping(n)", (3,), "ping calls itself", "loop"),
    "45 kernels, each called by another": ("x", "return link_44(x)", (1.0,), "link_5 is called through 40 other kernels", "fewer"),
    "an error in a kernel that is called": ("x", "return broken(x)", (1.0,), "in kernel 'broken': 'z' is not defined", "define"),
    "arguments of a kernel that are too many": ("x", "return x", (1.0, 2.0), "2 arguments", "parameters x"),
    # ------------------------------------------------------------------------------------- results
    "a returned array": ("w", "return w  # here", (FLOATS,), "an array of 1 dimensions is returned to Python", "numbers"),
    "a returned function": ("x", "return x, scaled  # here", (1.0,), "is returned to Python", "numbers"),
}  # fmt: skip

BEFORE = """\
TABLE, NAMED, LONG = (4, "a"), {"a": 1}, range(1025)
ARRAY, COUNTS, SMALL = np.zeros(3), np.zeros(3, np.int64), np.zeros(3, np.float32)


class Triple(NamedTuple):
    x: float
    n: int
    m: int


class Odd(Point):
    def __new__(cls, x):
        return super().__new__(cls, x, 1)


class Holder:
    @kernel
    def method(self, x):
        return x


OBJECT = Holder()


def later():
    @kernel
    def inner(x):
        return x * missing
    if not OBJECT:
        missing = 2
    return inner


LATER = later()


def plain(x):
    return x


@kernel
def scaled(x, by=2.5):
    return x * by


@kernel
def named(x, **names):
    return x


@kernel
def recursive(n):
    if n > 1:
        return recursive(n - 1)
    return n


@kernel
def ping(n):
    return pong(n)


@kernel
def pong(n):
    return ping(n)


@kernel
def broken(x):
    return x * z


@kernel
def link_0(x):
    return x
""" + "".join(f"\n\n@kernel\ndef link_{n}(x):\n    return link_{n - 1}(x)\n" for n in range(1, 45))


def refused(
    body: str, parameters: str, arguments: tuple[Any, ...], problem: str, remedy: str
) -> None:
    found = kernel_of(body, parameters, BEFORE)
    with pytest.raises(KernelError) as told:
        compiled(found)(*arguments)
    message = str(told.value)
    assert re.search(problem if "|" in problem else re.escape(problem), message), message
    assert remedy in message
    place, _, rest = message.partition(": ")
    file, _, line = place.rpartition(":")
    assert file.endswith(".py")
    assert "; " in rest
    lines = Path(file).read_text(encoding="utf-8").splitlines()
    marked = [n for n, text in enumerate(lines, 1) if text.endswith("# here")]
    if marked:
        assert [int(line)] == marked, message


@pytest.mark.parametrize("what", STATEMENTS)
def test_a_construct_outside_of_the_subset_is_refused(what: str) -> None:
    body, problem, remedy = STATEMENTS[what]
    refused(body, "x", (1.5,), problem, remedy)


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@pytest.mark.parametrize("what", MISTAKES)
def test_a_mistake_is_refused(what: str) -> None:
    parameters, body, arguments, problem, remedy = MISTAKES[what]
    refused(body, parameters, arguments, problem, remedy)
