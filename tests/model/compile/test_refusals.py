"""Every construct outside of the subset and every mistake, one by one, is refused in words."""

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
    "try, finally": ("try:  # here\n    x = 1\nfinally:\n    x = 2", "`try:`", "test before"),
    "with": ("with open('a') as f:  # here\n    pass", "`with open('a') as f:`", "caller"),
    "raise": ("raise ValueError  # here", "`raise ValueError`", "return a number"),
    "assert": ("assert x > 0  # here", "`assert x > 0`", "where Python calls"),
    "del": ("y = x\ndel y  # here", "`del y`", "leave the name"),
    "global": ("global FOUND  # here\nFOUND = x", "`global FOUND`", "return"),
    "global, in code that is left out": ("if False:\n    global FOUND  # here\nFOUND = x", "`global FOUND`", "return"),
    "import": ("import math  # here", "`import math`", "top of the file"),
    "from import": ("from math import pi  # here", "`from math import pi`", "top of the file"),
    "def": ("def inner(y):  # here\n    return y\nreturn inner(x)", "`def inner(y):`", "outside"),
    "class": ("class Inner:  # here\n    pass", "`class Inner:`", "outside"),
    "match": ("match x:  # here\n    case 1:\n        return 1", "`match x:`", "if and elif"),
    "for else": ("for i in range(3):  # here\n    pass\nelse:\n    x = 1", "`else` of a loop", "if after"),
    "for each else": ("for i in (1, 2):  # here\n    pass\nelse:\n    x = 1", "`else` of a loop", "if after"),
    "while else": ("while x > 1:  # here\n    x -= 1\nelse:\n    x = 1", "`else` of a loop", "if after"),
    "walrus": ("if (y := x) > 1:  # here\n    pass", "`(y := x)`", "assign before"),
    "lambda": ("f = lambda y: y  # here\nreturn f(x)", "`lambda y: y`", "a kernel"),
    "list": ("y = [x, 2]  # here", "`[x, 2]`", "tuple"),
    "list comprehension": ("y = [v for v in (x, 1)]  # here", "`[v for v in (x, 1)]`", "tuple(... for"),
    "set": ("y = {x, 2}  # here", "`{x, 2}`", "tuple"),
    "set comprehension": ("y = {v for v in (x, 1)}  # here", "`{v for v", "tuple"),
    "dict": ("y = {1: x}  # here", "`{1: x}`", "table"),
    "dict comprehension": ("y = {v: 1 for v in (x, 1)}  # here", "`{v: 1", "table"),
    "f-string": ("y = f'{x}'  # here", "f'{x}'", "text"),
    "an ellipsis of a long expression": (f"y = [{', '.join(['x'] * 40)}]  # here", "a node of Python's syntax", "tuple"),
    "a starred target": ("a, *b = x, 1, 2  # here", "3 values for 2 names", "each name"),
    "a starred name": ("y = *(x, 1), 2\n(*y,) = y  # here", "values for 1 names", "each name"),
    "a target that is a member": ("p = Point(x, 1)\np.x = 2.0  # here", "to a member", "_replace"),
    "a target that is a tuple": ("t = (x, 1)\nt[0] = 2.0  # here", "into a tuple of a float, an int", "arrays"),
    "a target that is static": ("TABLE[0] = 2.0  # here", "into the object", "arrays"),
    "matrices": ("y = x @ x  # here", "MatMult", "sums"),
}  # fmt: skip

MISTAKES = {
    # --------------------------------------------------------------------------------------- names
    "an unknown name": ("x", "y = x + z  # here", (1.0,), "'z' is not defined", "define or import"),
    "a name of one branch": ("x", "if x > 0:\n    y = 1\nreturn y  # here", (1.0,), "'y' is not assigned on every way", "before the branch"),
    "a name of a loop": ("n", "for i in range(n):\n    y = i\nreturn y  # here", (3,), "'y' is not assigned on every way", "before"),
    "a counter after its loop": ("n", "for i in range(n):\n    pass\nreturn i  # here", (3,), "'i' is not assigned", "before"),
    "a name before it is assigned": ("x", "y = z  # here\nz = x", (1.0,), "'z' is not assigned", "before"),
    "a name of a generator": ("x", "t = tuple(v for v in (x, 1))\nreturn v  # here", (1.0,), "'v' is not defined", "define"),
    "a cell that is empty": ("x", "return LATER(x)", (1.0,), "not associated|empty|free variable", "pass"),
    "a number here, a tuple there": ("x", "if x > 0:\n    y = 1\nelse:\n    y = (1, 2)\nreturn y  # here", (1.0,), "'y' is an int here and a tuple of an int, an int there", "one type"),
    "an int here, a float there": ("x", "if x > 0:\n    y = 1\nelse:\n    y = 2.0\nreturn y  # here", (1.0,), "'y' is an int here and a float there", "one type"),
    "an int that becomes a float": ("n", "y = 0\nfor i in range(n):  # here\n    y += 0.5\nreturn y", (3,), "'y' is an int before a round of the loop and a float after it", "one type"),
    "a choice of an int and a float": ("x", "return x if x > 0 else 0  # here", (1.0,), "a value that is a float or an int", "0.0, not 0"),
    "a choice of a bool and an int": ("x", "return True if x > 0 else 0  # here", (1.0,), "a value that is a bool or an int", "same type"),
    "an item of several types": ("n", "return (1, 2.0)[n]  # here", (1,), "a value that is an int or a float", "same type"),
    "results that are an int and a float": ("x", "if x > 0:\n    return x\nreturn 0  # here", (1.0,), "returns a float and an int", "one type"),
    "one of known items after a loop": ("x", "for v in (1, 2):\n    if x > v:\n        break\nreturn v  # here", (1.0,), "'v' is the number 1 here and the number 2 there", "one type"),
    "a function here, another there": ("x", "f = double if x > 0 else scaled  # here\nreturn f(x)", (1.0,), "'double' or the object 'scaled'", "same type"),
    "a tuple here, a longer one there": ("x", "if x > 0:\n    y = (1, 2)\nelse:\n    y = (1, 2, 3)\nreturn y[0]  # here", (1.0,), "a tuple of an int, an int here and a tuple of an int, an int, an int there", "one type"),
    "other named tuples": ("x", "p = Point(x, 1, True) if x > 0 else Triple(x, 1, 2)  # here", (1.0,), "a tuple Point of a float, an int, a bool or a tuple Triple of", "same type"),
    "a loop that changes a type": ("n", "y = 0\nfor i in range(n):  # here\n    y = (y, 1)\nreturn n", (3,), "'y' is an int before a round of the loop and a tuple of an int, an int after it", "one type"),
    "a while loop that changes a type": ("n", "y = ()\nwhile len(y) < n:  # here\n    y = (*y, 1)\nreturn n", (3,), "'y' is a tuple of nothing before a round of the loop and a tuple of an int after it", "one type"),
    "results of two types": ("x", "if x > 0:\n    return x\nreturn x, 1  # here", (1.0,), "returns a float and a tuple of a float, an int", "one type"),
    "a result and none": ("x", "if x > 0:\n    return x", (1.0,), "returns a float and the object None", "one type"),
    "an int that does not fit": ("x", "return x + 9223372036854775808 * 1  # here", (1.0,), "9223372036854775808 does not fit", "float"),
    # -------------------------------------------------------------------------------------- values
    "a float as an index": ("w, x", "return w[x]  # here", (FLOATS, 1.0), "a float as an index", "int("),
    "a float as an index of a tuple": ("x", "return (1, 2)[x]  # here", (1.0,), "a float as an index", "int("),
    "a known float as an index": ("w", "return w[1.0]  # here", (FLOATS,), "a float as an index", "int("),
    "a bool as an index": ("w, b", "return w[b]  # here", (FLOATS, True), "a bool as an index", "int("),
    "None as an index": ("w", "return w[None][0]  # here", (FLOATS,), "must be a number", "pass"),
    "an ellipsis as an index": ("w", "return w[...][0]  # here", (FLOATS,), "must be a number", "pass"),
    "a tuple as an index": ("w", "i = (0, 1)\nreturn w[i]  # here", (ROWS,), "an index must be a number, and is a tuple", "pass"),
    "an index from the end": ("w", "return w[-1]  # here", (FLOATS,), "the index -1 of an array", "from the beginning"),
    "an index from the end, by a name": ("w", "i = -1\nreturn w[i]  # here", (FLOATS,), "the index -1", "beginning"),
    "an index that cannot be": ("w", "return w[0, 2]  # here", (ROWS,), "the index 2 of 2", "exists"),
    "an index of a tuple that cannot be": ("x", "return (x, 1)[2]  # here", (1.0,), "the index 2 of 2", "exists"),
    "a name as an index that cannot be": ("x", "i = 2\nreturn (x, 1)[i]  # here", (1.0,), "the index 2 of 2", "exists"),
    "an index of a table that cannot be": ("x", "return TABLE[5]  # here", (1.0,), "index out of range", "pass"),
    "a key that cannot be": ("x", "return NAMED['c']  # here", (1.0,), "'c'", "pass"),
    "a key at run time": ("n", "return NAMED[n]  # here", (1,), "such an index of", "tuple"),
    "an index of nothing": ("n", "return ()[n]  # here", (1,), "the index 0 of 0 items", "exists"),
    "too many indices": ("w", "return w[0, 1, 0]  # here", (ROWS,), "3 indices of an array of 2", "at most"),
    "two indices of a tuple": ("x", "return (x, 1)[0, 1]  # here", (1.0,), "2 indices of a tuple", "one"),
    "a number with an index": ("x", "return x[0]  # here", (1.0,), "the items of a float", "tuple"),
    "a slice with a step": ("w", "return w[::2][0]  # here", (FLOATS,), "a slice with a step", "range"),
    "a slice of a tuple at run time": ("n", "return (1, 2, 3)[n:]  # here", (1,), "such a slice", "known"),
    "an array as a number": ("w", "return w + 1  # here", (FLOATS,), "must be a number, and is an array of 1", "pass"),
    "an array as a condition": ("w", "if w:  # here\n    return 1\nreturn 2", (FLOATS,), "must be a number", "pass"),
    "an array in a comparison": ("w", "return w == 1.0  # here", (FLOATS,), "must be a number", "pass"),
    "an array into an array": ("w", "w[0:2] = w[1:3]  # here", (FLOATS,), "must be a number", "pass"),
    "arithmetic on a part": ("w", "w[0:2] += 1.0  # here", (FLOATS,), "a part of an array", "loop"),
    "a tuple into an array": ("w", "w[0] = (1, 2)  # here", (FLOATS,), "must be a number", "pass"),
    "writing a constant array": ("x", "ARRAY[0] = x  # here", (1.0,), "into the object", "arrays"),
    "writing a part of a constant array": ("x", "v = ARRAY[1:]\nv[0] = x  # here", (1.0,), "a constant array", "arrays"),
    "counting in a constant array": ("x", "return fetch_add(COUNTS[0:1], 1)  # here", (1.0,), "fetch_add to an array", "run time"),
    "counting in an array of floats": ("w", "return fetch_add(w, 1)  # here", (FLOATS,), "fetch_add to an array", "int64"),
    "counting by a float": ("k", "return fetch_add(k, 0.5)  # here", (INTS,), "a float as a count", "int("),
    "an array of other numbers": ("x", "return SMALL[0] + x  # here", (1.0,), "float32", "float64 or int64"),
    "an array without dimension": ("x", "return POINT[()] + x  # here", (1.0,), "float64 with 0 dimensions", "at least one"),
    "a sum of tuples and numbers": ("x", "return (x, 1) + x  # here", (1.0,), "arithmetic on tuples", "item by item"),
    "a difference of tuples": ("x", "return (x, 1) - (1, x)  # here", (1.0,), "arithmetic on tuples", "item by item"),
    "a repeated tuple": ("x", "return (x, 1) * 2  # here", (1.0,), "arithmetic on tuples", "item by item"),
    "the sign of a tuple": ("x", "return -(x, 1)  # here", (1.0,), "must be a number", "pass"),
    "a comparison of tuples": ("x", "return (x, 1) == (1, x)  # here", (1.0,), "comparison of tuples", "item by item"),
    "a tuple among tuples": ("x", "return (x, 1) in ((1, 2), (3, 4))  # here", (1.0,), "comparison of tuples", "item by item"),
    "a comparison with text": ("x", "return x == 'a'  # here", (1.0,), "must be a number, and is the object 'a'", "pass"),
    "an order of text and numbers": ("x", "return 'a' < 1  # here", (1.0,), "not supported", "pass"),
    "is of numbers": ("x", "return x is 1.0  # here", (1.0,), "`is` without None", "write =="),
    "is of known numbers": ("x", "return 1 is 1.0  # here", (1.0,), "`is` without None", "write =="),
    "is of a bool": ("b", "return b is True  # here", (True,), "`is` without None", "write =="),
    "is of a tuple": ("p", "return p is TABLE  # here", ((1, 2),), "`is` without None", "write =="),
    "and of numbers": ("x, n", "return x and n  # here", (1.0, 2), "what is no bool", "compare"),
    "and of a known number": ("b", "return b and 5  # here", (True,), "what is no bool", "compare"),
    "or of a tuple": ("b", "return b or (1, 2)  # here", (True,), "what is no bool", "compare"),
    "or of None": ("x", "return None or x  # here", (1.0,), "what is no bool", "compare"),
    "// of a float": ("x", "return x // 2  # here", (1.0,), "// or % of a float", "floor(a / b)"),
    "% of a float": ("n, x", "return n % x  # here", (1, 2.0), "// or % of a float", "floor(a / b)"),
    "//= of a float": ("x", "x //= 2  # here", (1.0,), "// or % of a float", "floor(a / b)"),
    "a known division by 0": ("x", "return x + 1 / 0  # here", (1.0,), "division by zero", "pass"),
    "// by a known 0": ("n", "return n // 0  # here", (1,), "division by 0", "another"),
    "a power of two ints": ("n, m", "return n ** m  # here", (1, 2), "a power of two ints", "float"),
    "a negative power of an int": ("n", "return n ** -1  # here", (1,), "a power of two ints", "float"),
    "a power that is complex": ("x", "return x + (-1) ** 0.5  # here", (1.0,), "must be a number, and is the object", "pass"),
    "bits of a float": ("x", "return x & 1  # here", (1.0,), "a float as an operand", "int("),
    "bits of a known float": ("x", "return ~1.5  # here", (1.0,), "bad operand", "pass"),
    "~ of a float": ("x", "return ~x  # here", (1.0,), "a float as an operand", "int("),
    "a shift of a float": ("x", "return x << 1  # here", (1.0,), "a float as an operand", "int("),
    "a long shift": ("n", "return n << 64  # here", (1,), "a shift by 64", "0 to 63"),
    "a negative shift": ("n", "return n >> -1  # here", (1,), "a shift by -1", "0 to 63"),
    "a known shift that is negative": ("n", "return n + (1 >> -1)  # here", (1,), "negative shift", "pass"),
    # -------------------------------------------------------------------------------------- tuples
    "too few values": ("t", "a, b, c = t  # here", ((1, 2),), "2 values for 3 names", "each name"),
    "too many values": ("t", "a, b = t  # here", ((1, 2, 3),), "3 values for 2 names", "each name"),
    "values of a number": ("x", "a, b = x  # here", (1.0,), "the items of a float", "tuple"),
    "values of a long array": ("w", "a, b = w  # here", (FLOATS,), "the items of an array", "range"),
    "a field that does not exist": ("p", "return p.x + p.z  # here", ((1.0, 2),), "has no 'x'", "member"),
    "a field of a named tuple that does not exist": ("x", "return Point(x, 1).z  # here", (1.0,), "a tuple Point of a float, the number 1, the number False has no 'z'", "member"),
    "a member of a number": ("x", "return x.real  # here", (1.0,), "a float has no 'real'", "member"),
    "a method of an array": ("w", "return w.sum()  # here", (FLOATS,), "an array of 1 dimensions has no 'sum'", "member"),
    "a member of a module": ("x", "return math.tau2 + x  # here", (1.0,), "has no 'tau2'", "member"),
    "_replace of an unknown field": ("x", "return Point(x, 1)._replace(z=1)  # here", (1.0,), "_replace of z", "x, n, flag"),
    "_replace by position": ("x", "return Point(x, 1)._replace(1)  # here", (1.0,), "_replace with such arguments", "write"),
    "_replace of a tuple": ("x", "return (x, 1)._replace(x=1)  # here", (1.0,), "a tuple of a float, the number 1 has no '_replace'", "member"),
    "a named tuple with too few fields": ("x", "return Point(x)  # here", (1.0,), "missing a required argument: 'n'", "call Point"),
    "a named tuple with too many fields": ("x", "return Point(x, 1, True, 2)  # here", (1.0,), "too many positional", "call Point"),
    "a field given twice": ("x", "return Point(x, 1, x=2)  # here", (1.0,), "multiple values for argument 'x'", "call Point"),
    "an unknown field": ("x", "return Point(x, 1, z=2)  # here", (1.0,), "unexpected keyword argument 'z'", "call Point"),
    "a class with a __new__": ("x", "return Odd(x)  # here", (1.0,), "a __new__ of its own", "kernel"),
    "an iterator that is kept": ("x", "t = (v for v in (x, 1))  # here\nreturn tuple(t)", (1.0,), "an iterator that is kept", "tuple(...)"),
    "a zip that is kept": ("t", "z = zip(t, t)  # here\nreturn tuple(z)", ((1, 2),), "an iterator that is kept", "tuple(...)"),
    "a returned generator": ("x", "return (v for v in (x, 1))  # here", (1.0,), "an iterator that is kept", "tuple(...)"),
    "a loop over a generator": ("x", "for v in (x * n for n in (1, 2)):  # here\n    x = v\nreturn x", (1.0,), "a loop over an iterator", "tuple"),
    "a loop over a zip of a generator": ("x", "for v in zip((x * n for n in (1, 2)), (1, 2)):  # here\n    x = v[0]\nreturn x", (1.0,), "a loop over an iterator", "tuple"),
    "the length of a generator": ("x", "return len(v for v in (x, 1))  # here", (1.0,), "the length of an iterator", "tuple"),
    "an item of a generator": ("x", "return zip((x, 1), (1, 2))[0]  # here", (1.0,), "an iterator that is kept", "tuple"),
    "a generator at run time": ("n", "return tuple(v for v in range(n))  # here", (3,), "a range of run time", "for statement"),
    "items that are left out at run time": ("t", "return tuple(v for v in t if v > 1)  # here", ((1, 2),), "leaves out items at run time", "known"),
    "a loop over an array": ("w", "for v in w[0]:  # here\n    w[0, 1] = v\nreturn 1", (ROWS,), "a loop over an array", "range"),
    "a loop over an array of any length": ("w", "for v in w:  # here\n    pass\nreturn 1", (FLOATS,), "a loop over an array", "range"),
    "a loop over rows of any number": ("w", "for v in w:  # here\n    pass\nreturn 1", (ROWS,), "the items of an array", "range"),
    "a loop over a number": ("n", "for v in n:  # here\n    pass\nreturn 1", (3,), "the items of an int", "range"),
    "a loop over too much": ("n", "for v in LONG:  # here\n    n += v\nreturn n", (3,), "1025 items to be unrolled", "range"),
    "a loop over an iterator from outside": ("n", "for v in ITERATOR:  # here\n    n += v\nreturn n", (3,), "the items of", "tuple"),
    "a loop over a set": ("n", "for v in SET:  # here\n    n += v\nreturn n", (3,), "the items of", "tuple"),
    "a star of an array": ("w", "return max(*w)  # here", (FLOATS,), "the items of an array", "range"),
    "a zip of different lengths": ("t", "s = 0\nfor a, b in zip(t, (1, 2, 3)):  # here\n    s += a\nreturn s", ((1, 2),), "zip of 2, 3 items", "same number"),
    # --------------------------------------------------------------------------------------- loops
    "range of a float": ("x", "for i in range(x):  # here\n    pass", (3.0,), "a float as an end of a range", "int("),
    "range with a step of run time": ("n", "for i in range(0, 9, n):  # here\n    pass", (3,), "step is 0 or not known", "int"),
    "range with a step of 0": ("n", "for i in range(0, 9, 0):  # here\n    pass", (3,), "step is 0", "int"),
    "range of nothing": ("n", "for i in range():  # here\n    pass", (3,), "range of 0 values", "takes"),
    "range of four": ("n", "for i in range(1, 2, 3, 4):  # here\n    pass", (3,), "range of 4 values", "takes"),
    "range by names": ("n", "for i in range(stop=n):  # here\n    pass", (3,), "range with names", "position"),
    "each_lane of a number": ("n", "for i in each_lane(n):  # here\n    pass", (3,), "each_lane of 1 values", "takes"),
    "range with another meaning": ("range", "s = 0\nfor i in range(3):  # here\n    s += i\nreturn s", (len,), "another meaning", "another name"),
    "an unpacked counter": ("n", "for i, j in range(n):  # here\n    pass", (3,), "the items of an int", "tuple"),
    # --------------------------------------------------------------------------------------- calls
    "a function that is no kernel": ("x", "return plain(x)  # here", (1.0,), "'plain' is no kernel", "@kernel"),
    "a function of numpy": ("x", "return np.cos(x)  # here", (1.0,), "'cos' is no kernel", "@kernel"),
    "round": ("x", "return round(x)  # here", (1.0,), "'round' is no kernel", "@kernel"),
    "sum": ("t", "return sum(t)  # here", ((1, 2),), "'sum' is no kernel", "@kernel"),
    "print": ("x", "print('a')  # here", (1.0,), "'print' is no kernel", "@kernel"),
    "a method of a list": ("x", "LIST.append(1)  # here\nreturn x", (1.0,), "'append' is no kernel", "@kernel"),
    "a call of a number": ("x", "return x(1)  # here", (1.0,), "a call of a float", "kernel"),
    "a call of a string": ("x", "return 'a'(1)  # here", (1.0,), "'a'", "@kernel"),
    "too few arguments": ("x", "return scaled()  # here", (1.0,), "scaled: missing a required argument: 'x'", "call scaled(x, by=2.5)"),
    "too many arguments": ("x", "return scaled(x, 1, 2)  # here", (1.0,), "too many positional", "call scaled"),
    "an unknown keyword": ("x", "return scaled(x, to=2)  # here", (1.0,), "unexpected keyword argument 'to'", "call scaled"),
    "a keyword twice": ("x", "return scaled(x, x=2)  # here", (1.0,), "multiple values for argument 'x'", "call scaled"),
    "arguments by **": ("x", "return scaled(x, **NAMED)  # here", (1.0,), "arguments by **", "one by one"),
    "a kernel with **": ("x", "return named(x, a=1)  # here", (1.0,), "takes **names", "parameters"),
    "a method": ("x", "return OBJECT.method(x)  # here", (1.0,), "the kernel <bound method", "outside of a class"),
    "a builtin with too few arguments": ("x", "return abs()  # here", (1.0,), "abs: missing", "takes"),
    "a builtin with too many arguments": ("x", "return abs(x, 1)  # here", (1.0,), "abs: too many", "takes"),
    "a builtin with names": ("x", "return max(x, 1.0, key=abs)  # here", (1.0,), "max with key", "position"),
    "min of nothing": ("x", "return min(())  # here", (1.0,), "the extreme of nothing", "a number"),
    "min of no argument": ("x", "return min()  # here", (1.0,), "min", "pass"),
    "min of a tuple and a number": ("x", "return min((x, 1), x)  # here", (1.0,), "must be a number, and is a tuple", "pass"),
    "sqrt of a known negative number": ("x", "return sqrt(-1.0)  # here", (1.0,), "math domain", "pass"),
    "sqrt of an array": ("w", "return sqrt(w)  # here", (FLOATS,), "must be a number", "pass"),
    "int of two": ("n", "return int(n, 8)  # here", (1,), "int: too many", "takes"),
    "isinstance of what is not known": ("x", "return isinstance(x, x)  # here", (1.0,), "class that is not known", "name the class"),
    "isinstance of no class": ("x", "return isinstance(x, 'a')  # here", (1.0,), "issubclass", "pass"),
    "getattr at run time": ("x, n", "return getattr(Point(x, n), n)  # here", (1.0, 2), "chosen at run time", "if"),
    "getattr with a default": ("x", "return getattr(Point(x, 1), 'z', 0.0)  # here", (1.0,), "getattr: too many", "takes"),
    "len of a number": ("x", "return len(x)  # here", (1.0,), "the length of a float", "tuple"),
    "where of tuples": ("b", "return np.where(b, (1, 2), (3, 4))  # here", (True,), "must be a number", "pass"),
    "a view of a bool": ("b", "return b.view(np.int64)  # here", (True,), "a bool has no 'view'", "member"),
    "a view as bytes": ("w", "return w.view(np.uint8)[0]  # here", (FLOATS,), "view with such", "np.int64"),
    "a view of nothing": ("w", "return w.view()[0]  # here", (FLOATS,), "view with such", "np.int64"),
    "a view by name": ("w", "return w.view(dtype=np.int64)[0]  # here", (FLOATS,), "view with such", "np.int64"),
    "recursion": ("n", "return recursive(n)", (3,), "recursive calls itself", "loop"),
    "recursion by another": ("n", "return ping(n)", (3,), "ping calls itself", "loop"),
    "recursion of a separate kernel": ("n", "return apart(n)", (3,), "apart calls itself", "loop"),
    "45 kernels, each called by another": ("x", "return link_44(x)", (1.0,), "link_5 is called through 40 other kernels", "fewer"),
    "recursion with other types": ("n", "return growing((n,))", (3,), "growing calls itself", "loop"),
    "an error in a kernel that is called": ("x", "return broken(x)", (1.0,), "in kernel 'broken': 'z' is not defined", "define"),
    "arguments of a kernel that are too many": ("x", "return x", (1.0, 2.0), "2 arguments", "parameters x"),
    "arguments of a kernel that are too few": ("x, y", "return x", (1.0,), "1 arguments", "parameters x, y"),
    # ------------------------------------------------------------------------------------- results
    "a returned array": ("w", "return w  # here", (FLOATS,), "an array of 1 dimensions is returned to Python", "numbers"),
    "a returned function": ("x", "return x, scaled  # here", (1.0,), "is returned to Python", "numbers"),
    "a returned text": ("x", "return 'a'  # here", (1.0,), "is returned to Python", "numbers"),
}  # fmt: skip

BEFORE = """\
TABLE, NAMED, LONG, ITERATOR, SET = (4, "a"), {"a": 1}, range(1025), iter((1, 2)), {1, 2}
ARRAY, COUNTS, SMALL = np.zeros(3), np.zeros(3, np.int64), np.zeros(3, np.float32)
LIST, POINT = [], np.zeros(())


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
def double(x):
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


@separate_kernel
def apart(n):
    return apart(n)


@kernel
def growing(t):
    return growing((*t, 1))


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
