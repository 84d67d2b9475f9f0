"""Every construct of the subset, one by one, against Python."""

# ruff: noqa: E501 - a line is a case

from typing import Any

import numpy as np
import pytest

from tests.model.compile.sources import bits, exactly, load

NAN, INF = float("nan"), float("inf")

# (parameters, body): the kernel, called with each of the arguments that stand below its parameters
ARGUMENTS: dict[str, list[tuple[Any, ...]]] = {
    "": [()],
    "x": [(0.0,), (-0.0,), (1.5,), (-2.5,), (NAN,), (INF,), (1e300,), (3.0,)],
    "n": [(0,), (1,), (-1,), (7,), (-8,), (2**62,)],
    "b": [(True,), (False,)],
    "x, y": [(1.5, 2.0), (-0.0, 0.0), (0.0, -0.0), (NAN, 1.0), (1.0, NAN), (-3.5, 2.5), (INF, 2.0)],
    "n, m": [(7, 2), (-7, 2), (7, -2), (-7, -2), (6, 3), (-6, 3), (2**62, 5), (0, -9)],
    "x, n": [(1.5, 2), (2.0, 2), (-0.5, -3), (NAN, 1), (1e300, 7)],
    "x, n, b": [(1.5, 2, True), (2.0, 2, False), (-0.5, -3, True), (NAN, 4, False)],
    "b, c": [(b, c) for b in (True, False) for c in (True, False)],
    "t": [((1.5, 2),), ((-0.0, -7),)],
    "w": [(np.array([1.5, -2.0, 0.25, 8.0]),), (np.arange(20.0)[1:18:4],), (np.arange(5.0)[::-1],)],
    "w, n": [(np.array([1.5, -2.0, 0.25, 8.0]), 2), (np.arange(20.0)[1:18:4], 1)],
    "w, n, m": [(np.arange(4.0), n, m) for n in range(-6, 7) for m in (-9, -5, -2, 0, 1, 3, 4, 7)],
    "a, n, m": [(np.arange(12.0).reshape(4, 3), n, m) for n in range(-5, 6) for m in (-2, 0, 2, 9)],
    "k, n": [(np.array([5, -6, 7]), 1), (np.arange(9)[::3], 2)],
    "a": [(np.arange(12.0).reshape(4, 3),), (np.arange(12.0).reshape(3, 4).T,),
          (np.arange(24.0).reshape(4, 6)[:, ::2],)],
}  # fmt: skip

SAME_AS_PYTHON = {
    # ---------------------------------------------------------------------------------- numbers
    "sums": ("x, y", "return x + y, x - y, x * y, -x, +y, x + 1, 2 * y, 1 - x"),
    "quotient": ("x, y", "return x / (y + 0.125), 1 / (x - 100.0), 7 / 2"),
    "sums of ints": ("n, m", "return n + m, n - m, -n, +n, 3 - m, n % 99 * 3"),
    "quotients of ints": ("n, m", "return n / m, n // m, n % m, n // 3, n % 3, n // -3, n % -3"),
    "quotients of what is known": ("n", "return 7 // 2, -7 // 2, 7 % -2, 7.5 // 2, n + 2**3"),
    "bits": ("n, m", "return n & m, n | m, n ^ m, ~n, n >> 3, n >> (m & 7), (n & 255) << 4"),
    "bools in sums": ("b, c", "return b + c, b - c, b * 3, -b, +b, ~b, b / (c + 1), b // 1, b % 2"),
    "bits of bools": ("b, c", "return b & c, b | c, b ^ c, b & 3, b << 2, 1 >> c"),
    "sums of each kind": ("x, n, b", "return x + n, n * x, b + n, x - b, n / 2, x * b"),
    "squares": ("x, n", "return min(x, 9.0) ** 2, (n % 5) ** 2, x ** 1, (n % 5) ** 1"),
    "a power with a float exponent": ("n, m", "return n ** 2.0, float(m) ** 1.0"),
    "a power of a bool": ("b", "return b ** 1 + 1"),
    "known powers": ("x", "return x * 2 ** 10, 2.0 ** -52, 2 ** 0.5, (-8) ** 3"),
    "the largest int": ("n", "return n & 9223372036854775807, n & -9223372036854775808"),
    "zeros": ("x", "return 0 + x, x + 0, x * 1, 0 - x, x - 0, -x, 0.0 - x, x * 0"),
    "conversions": ("x, n, b", "return float(n), float(b), int(b), bool(n), bool(x), int(1.9), bool(2)"),
    "float to int": ("x, y", "return int(min(max(x if x == x else 0.0, -9e18), 9e18))"),
    "conversions by numpy": ("n", "return np.float64(n) / 2, np.int64(n) + 1"),
    "bits of a float": ("n", "return np.float64(n).view(np.int64) + 1"),
    "known strings": ("x", "return x + float('0.5') + int('7')"),
    "infinity": ("x", "return inf + 1.0, -inf, nan, math.inf, np.pi * x, 1e400"),
    # ------------------------------------------------------------------------- comparisons, truth
    "comparisons": ("x, y", "return x < y, x <= y, x > y, x >= y, x == y, x != y"),
    "comparisons of ints": ("n, m", "return n < m, n <= m, n > m, n >= m, n == m, n != m"),
    "comparisons of bools": ("b, c", "return b < c, b <= c, b == c, b != c, b > c, b == 1, b < 2"),
    "comparisons of each kind": ("x, n, b", "return x < n, n == x, b == x, b < n, n != 2.0"),
    "chains": ("x, y", "return x < y < 3.0, 0 <= x <= y, x == y == 0.0, 1.0 > x != y"),
    "not": ("x, n, b", "return not x, not n, not b, not (x < n), not (), not 'a'"),
    "and, or": ("b, c", "return b and c, b or c, b and not c or c, True and b, False or c, b or True"),
    "three of and": ("x, n, b", "return b and x < 1.0 and n > 1, b or x < 1.0 or n > 1"),
    "and by need": ("k, n", "return n < 3 and k[n] > 0, n >= 2 or k[n + 1] > 0"),
    "bool and in conditions": ("x, n, b", "if b and (x > 1.0 or n == 2):\n    return 1\nreturn 0"),
    "in": ("n, m", "return n in (1, 7, m), m not in (2, -2), n in range(8), 2 in (1, 2)"),
    "in what is known": ("x", "return 'b' in 'abc', 'ab' in 'abc', 'ac' not in 'abc', x in (1.5, 2)"),
    "truth of numbers": ("x, n, b", "y = 0\nif x:\n    y += 1\nif n:\n    y += 2\nif b:\n    y += 4\nreturn y"),
    "truth of tuples": ("n", "t, e = (n, 0), ()\nreturn (1 if t else 2), (1 if e else 2)"),
    "is": ("n", "t = None\nreturn n is None, t is None, t is not None, None is None, math is None"),
    "a choice": ("x, n, b", "return (x if b else 2.5), (n if x > 0 else -n), (1.0 if b else 2.5), (b if n else x > 2)"),
    "a nested choice": ("x, y", "return 1.0 if x > y else -1.0 if x < y else (0.0 if x == y else 7.0)"),
    "a choice of tuples": ("x, n, b", "s, t = (x, n) if b else (1.0, 25)\nreturn s, t"),
    # ------------------------------------------------------------------------ functions of Python
    "min, max": ("x, y", "return min(x, y), max(x, y), min(x, y, 1.0), max(1.0, x, y), min((x, y))"),
    "min, max of each kind": ("x, n, b", "return max(x, n) + 0.0, min(n, x) * 1.0, max(n, b) + 0, min(b, 1) * 1, min((n,))"),
    "abs": ("x, n, b", "return abs(x), abs(n), abs(b), abs(-3)"),
    "sqrt": ("x", "return sqrt(abs(x)), math.sqrt(4), math.sqrt(2.0)"),
    "isnan, isfinite": ("x", "return isnan(x), np.isnan(x), isfinite(x), isnan(3)"),
    "any, all": ("x, n, b", "return any((b, n == 2)), all((b, x > 0)), any(()), all(()), any(v > 1 for v in (x, n))"),
    "all of numbers": ("x, n, b", "return any((x, n)), all((n, b))"),
    "where": ("x, n, b", "return float(np.where(b, x, 2.5)), int(np.where(n > 1, n, 0))"),
    "len": ("w", "return len(w), len((1, 2)), len('abc'), len(w[1:3])"),
    "isinstance": ("x, n, b", "return isinstance(x, float), isinstance(n, int), isinstance(b, int), isinstance(b, bool), isinstance((x, n), tuple), isinstance('a', str), isinstance(n, bool)"),
    "getattr": ("x", "p = Point(x, 3)\nreturn getattr(p, 'x'), getattr(p, 'n'), getattr(math, 'pi')"),
    # ----------------------------------------------------------------------------- tuples, tables
    "tuples": ("x, y", "t = x, y, 3\nreturn t, t[0], t[-1], t[1:], t[:2], (*t, x), (1, *t[1:])"),
    "unpacking": ("t", "x, n = t\n(y, m), z = (n, x), 1\n[u, v] = t\nreturn x, n, y, m, z, u, v"),
    "exchange": ("x, y", "x, y = y, x\nx, y, z = y + 1.0, x, x\nreturn x, y, z"),
    "a star": ("t", "return (*t, 3, *t), max(*t) * 1.0, min(*t, *(1, 2)) * 1.0, (*(v * 2 for v in t),)"),
    "an item at run time": ("k, n", "return (4, 5, 6)[n], (k[0], 2, k[1])[n], SAME[n], ROWS[n][1], (1, 2, 3)[n > 1]"),
    "items of tables": ("n", "return TABLE[1], TABLE[-1], NAMED['b'], ROWS[1], len(ROWS), TABLE[0:2]"),
    "named tuples": ("x, n", "p = Point(x, n=n)\nx, m, flag = p\nreturn p, p.x, p[1], m, flag, Point(1, 2, True)"),
    "an attribute of a class": ("x", "p = Sized(x)\nreturn p.x * p.size, Sized.size"),
    "_replace": ("x, n", "p = Point(x, n)\nq = p._replace(n=7)\nr = ORIGIN._replace(x=x)\nreturn p, q, r, ORIGIN._replace(n=3)"),
    "named tuples of arguments": ("x, n", "return Pair(*(v for v in (x, n))), Pair(**{}, x=1, y=2) if False else n"),
    "generators": ("x, n", "return tuple(v * n for v in (x, 1, 2)), tuple((i, j) for i in range(3) for j in range(i))"),
    "a condition in a generator": ("x", "return tuple(x + v for v in range(6) if v % 2 == 0 if v)"),
    "a generator with a known name": ("x, n", "v = x + n\nt = tuple(v * 2.0 for v in (x, 1.0))\nreturn v, t"),
    "a generator in a generator": ("x", "i = 5\nt = tuple(tuple(i * x for i in range(j)) for j in range(3))\nreturn t, i"),
    "generators of parts": ("x, y", "s = tuple(a - b for a, (b, c) in zip((x, y), ((y, 1), (x, 2))))\nreturn s"),
    "zip, enumerate, reversed": ("x, y", "s = 0.0\nfor n, (a, b) in enumerate(zip((x, y), (1, 2), strict=True)):\n    s += n * a + b\nfor v in reversed((x, y)):\n    s = v - s\nreturn s"),
    "tuples of a tuple": ("t", "return tuple(t), tuple(range(3)), tuple(reversed(t)), tuple(zip(t, t)), tuple(enumerate(t))"),
    "static choice": ("x", "if 'a' == 'a':\n    y = x\nelse:\n    y = undefined\nreturn y"),
    # --------------------------------------------------------------------------- statements, loops
    "assignments": ("x, y", "a = b = x\na += y\na -= 1\na *= 2\na /= 4\nn: int = 3\nn //= 2\nn <<= 3\nn |= 1\nn %= 7\nz: float\nreturn a, b, n"),
    "branches": ("x, y", "if x > y:\n    r = 1\nelif x < y:\n    r = 2\nelif x == y:\n    r = 3\nelse:\n    r = 4\nreturn r"),
    "an argument that changes": ("x, n", "if x > n:\n    x = 0.5 * n\nfor i in range(3):\n    n = n * 2 + i\n    x = x * 0.5 + n\nreturn x, n"),
    "early returns": ("x, y", "if x > y:\n    return x\nif x < y:\n    return y\nreturn 0.5"),
    "no return": ("x", "y = x\npass\n'text'\n"),
    "an empty return": ("x", "if x > 0:\n    return\nreturn None"),
    "an empty tuple": ("x", "return (), (x, ())"),
    "while": ("n", "s = 0\ni = 0\nwhile i < n % 50:\n    i += 1\n    if i == 3:\n        continue\n    if i > 9:\n        break\n    s += i\nreturn s, i"),
    "while True": ("n", "i = 0\nwhile True:\n    i += 1\n    if i * i > n % 1000:\n        return i"),
    "while False": ("n", "while False:\n    n = 0\nreturn n"),
    "for": ("n", "s = 0\nfor i in range(n % 9):\n    s = 10 * s + i\nreturn s"),
    "ranges": ("n", "s = i = 0\nfor i in range(2, 9, 3):\n    s = 10 * s + i\nfor i in range(5, 0, -2):\n    s = 10 * s + i\nfor i in range(3, n % 8):\n    s += i\nfor i in range(True):\n    s += 1\nreturn s, i"),
    "a counter that is changed": ("n", "s = 0\nfor i in range(5):\n    s += i\n    i = 7 * i\n    s += i\nreturn s"),
    "a range that is changed": ("n", "m, s = 4, 0\nfor i in range(m):\n    m += 1\n    s += m\nreturn m, s"),
    "loops in loops": ("n", "s = 0\nfor i in range(4):\n    for j in range(i):\n        if j == 2:\n            break\n        if i == 2:\n            continue\n        s += 10 * i + j\n    s *= 3\nreturn s"),
    "for over items": ("x, n", "s = 0.0\nfor v in (x, n, 3):\n    if v == 2:\n        continue\n    s = 2 * s + v\nreturn s, v"),
    "break from items": ("x, n", "for v in (x, x + n, 3.0 * n):\n    if v == 2:\n        break\nreturn v"),
    "nothing to loop over": ("x", "v = x\nfor v in ():\n    v = 1.0\nfor i in range(0):\n    v = 2.0\nreturn v"),
    "static items": ("x", "s = 0.0\nfor name, by in (('x', 2), ('y', 3)):\n    s += getattr(Pair(x, 1.0), name) * by\nreturn s"),
    "equal items that differ": ("x", "s = x\nfor v in (0.0, -0.0, 1.0, True, 1):\n    s = 3.0 * s + math.copysign(1.0, v) + (7.0 if isinstance(v, bool) else 0.0) + (2.0 if isinstance(v, float) else 0.0)\nreturn s"),
    "functions as items": ("x", "s = 0.0\nfor f in (double, triple):\n    s = f(s) + f(x)\nreturn s"),
    "return from items": ("n", "for v in (1, 2, 3):\n    if v == n:\n        return v * 10\nreturn -1"),
    "items in a loop": ("n", "s = 0\nfor i in range(3):\n    for v in (1, 2):\n        s += v * i\nreturn s"),
    "a loop over rows": ("a", "s = 0.0\nfor row in ROWS_OF_FLOATS:\n    s += row[0] * row[1]\nreturn s + a[0, 0]"),
    # ------------------------------------------------------------------------------------- arrays
    "elements": ("w, n", "return w[0], w[n], w[n - 1], w[n] * w[2], w[int(1.5)]"),
    "writing": ("w, n", "w[0] = 3\nw[n] += 2.5\nw[n - 1] *= w[n]\nw[2], w[3] = w[3], w[2]\nreturn w[0]"),
    "writing ints": ("k, n", "k[0] = 7\nk[n] -= 9\nk[1] //= 2\nk[2] = True\nreturn k[n] // 4, k[0] % 3, k[n] / 2"),
    "parts": ("w", "v = w[1:]\nv[0] = 9.0\nu = v[1:3]\nu[:] = 4\nw[:1] = -1.0\nreturn len(v), len(u), w[1]"),
    **{
        f"the slice {ends}": (
            "w, n, m",
            f"w[{ends}] = 9.0\nreturn len(w[{ends}]), total(w[{ends}]), total(w)",
        )
        for ends in ("0:9", "5:9", ":-1", "-2:", "3:1", "-9:2", "n:", ":n", "n:m", "1:n", "n:3", "-3:m", "n:-1")
    },
    **{
        f"the slice {ends} of a row": (
            "a, n, m",
            f"a[1, {ends}] = 9.0\nreturn len(a[1, {ends}]), total(a[1]), len(a[{ends}])",
        )
        for ends in ("0:9", "-2:", "3:1", "-9:2", "n:", ":n", "n:m")
    },
    "a part of a part": ("w, n", "v = w[n:]\nv[0:2][0] = 5.0\nw[1:n] = 2.0\nreturn v[0], len(w[1:n])"),
    "rows": ("a", "r = a[1]\nr[2] = 50.0\nc = a[:, 1]\nc[0] = -1.0\nreturn r[0], a[1, 2], a[0][1], c[3], a.shape, a.size, len(r)"),
    "known indices of rows": ("a", "r = a[2]\nx, y, z = r\nreturn r[-1], a[0, -1], x, y, z, max(r), tuple(r), r[-2:][0] if False else z"),
    "filling": ("a", "a[1:3, 1:] = 7\na[0] = 1.0\nreturn a[2, 2]"),
    "arrays as arguments": ("w, n", "add_to(w, 0, 2.0)\nadd_to(w[n:], 0, 3.0)\nreturn w[0], total(w)"),
    "the order of +=": ("w, n", "w[0] += added(w)\nreturn w[0]"),
    "views": ("w", "return w[0] + w.view(np.int64)[0] * 0"),
    "constant arrays": ("n", "return FLOATS[0] + FLOATS[2], INTS[n % 3], MATRIX[1, n % 2], len(FLOATS), MATRIX[0][1]"),
    "items of constant arrays": ("n", "a, b, c = FLOATS\ns = 0.0\nfor v in FLOATS:\n    s += v\nreturn a, b, c, s"),
    "arrays in tuples": ("w, n", "t = (w, n)\nt[0][n] = 0.5\nv, m = t\nreturn v[m] + t[0][0]"),
    "a choice of arrays": ("w, n", "v = w if n > 1 else w\nreturn v[n]"),
    "fetch_add": ("k, n", "return fetch_add(k, n), fetch_add(k[1:], 2), k[0], k[1]"),
    "loops over lanes": ("w", "s = np.int64(0)\nfor i in each_lane():\n    s += i\nreturn s"),
    # -------------------------------------------------------------------------------------- calls
    "calls": ("x, n", "return double(x), double(by=n), scaled(x), scaled(x, by=3), scaled(by=n, x=x), double(double(n))"),
    "tuples of a call": ("x, n", "a, b = both(x, n)\np = as_point(x, n)\nreturn a, b, p, p.n, both(1, 2.5)"),
    "many values": ("x, n", "return collected(), collected(x), collected(x, n, 3), collected(*both(x, n))"),
    "parameters of each kind": ("x, n", "return ordered(x, n, last=2.5), ordered(1, n, 3, 4, last=x)"),
    "positions only": ("x, n", "return positional(x, n), positional(n, y=x)"),
    "a kernel as an argument": ("x, n", "return applied(double, x), applied(triple, n), applied(MADE, x)"),
    "a nested kernel": ("x, n", "return applied_twice(applied, double, x), MADE(n)"),
    "recursion over what is known": ("x", "return summed(x, (1, 2, 3))"),
    "a call without result": ("w", "r = nothing(w)\nnothing(w)\nreturn r is None, w[0]"),
    "a static function": ("x", "return x * len(str(1234)), sorted(ROWS)[0], math.factorial(4), math.cos(0.0)"),
    "separate": ("x, n", "return apart(x, n), apart(n, x), apart(x, n)[0]"),
    "names of the outside": ("x", "return x * FACTOR, math.pi, np.inf, max.__name__ == 'max'"),
}  # fmt: skip

BEFORE = """\
TABLE, SAME = (4, 5, 6.5), (4, 5, 6)
ROWS = ((1, 2), (3, 4), (5, 6))
NAMED = {"a": 1, "b": 2}
ORIGIN = Point(0.0, 0)
FLOATS, INTS = np.array([0.5, 1.5, -0.0]), np.array([3, 4, 5])
MATRIX, ROWS_OF_FLOATS = np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([[1.0, 2.5], [3.0, 4.0]])
FACTOR = 2.5


class Sized(NamedTuple):
    x: float
    size = 3


@kernel
def double(by):
    return by * 2


@inlined_kernel
def triple(x):
    return x * 3


@kernel
def scaled(x, by=2.5):
    return x * by


@kernel
def both(x, n):
    return n, x


@kernel
def as_point(x, n):
    return Point(x, n)


@kernel
def collected(*values):
    return len(values), values


@kernel
def ordered(x, *others, y=7, last):
    return x, others, y, last


@kernel
def positional(x, /, y):
    return x - y


@kernel
def applied(function, x):
    return function(x) + 1


@kernel
def applied_twice(apply, function, x):
    return apply(function, apply(function, x))


def make(by):
    @kernel
    def made(x):
        return x * by
    return made


MADE = make(7)


@kernel
def summed(x, values):
    if len(values) == 0:
        return x
    return summed(x, values[1:]) + values[0]


@kernel
def nothing(w):
    w[0] += 1.0


@kernel
def add_to(w, n, x):
    w[n] += x


@kernel
def added(w):
    w[0] = 100.0
    return 1.0


@kernel
def total(w):
    s = 0.0
    for i in range(len(w)):
        s += w[i]
    return s


@separate_kernel
def apart(x, n):
    return x - n, n
"""


@pytest.fixture(scope="module")
def kernels() -> dict[str, Any]:
    """All kernels of the table, in one module."""
    text = "".join(
        f"\n\n@kernel\ndef tried_{n}({parameters}):\n    " + "\n    ".join(body.splitlines()) + "\n"
        for n, (parameters, body) in enumerate(SAME_AS_PYTHON.values())
    )
    module = load(BEFORE + text)
    return {name: getattr(module, f"tried_{n}") for n, name in enumerate(SAME_AS_PYTHON)}


def copied(values: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(each.copy() if isinstance(each, np.ndarray) else each for each in values)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # ~ of a bool
@pytest.mark.parametrize("name", SAME_AS_PYTHON)
def test_it_is_as_in_python(kernels: dict[str, Any], name: str) -> None:
    compiled = exactly(kernels[name])
    for values in ARGUMENTS[SAME_AS_PYTHON[name][0]]:
        mine, pythons = copied(values), copied(values)
        with np.errstate(all="ignore"):
            expected = kernels[name](*pythons)
        assert bits(compiled(*mine)) == bits(expected), values
        assert bits(mine) == bits(pythons), values
