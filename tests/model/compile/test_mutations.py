"""A mistake in any one place of the compiler is caught by its tests.

Each mutation is one edit of a copy of the package, on which the tests run until one fails.
"""

# ruff: noqa: E501 - a line is a case

from pathlib import Path

import pytest

from tests.model.mutations import assert_caught, run_on_copy

TESTS = [
    f"tests/model/compile/test_{each}.py"
    for each in (
        "subset", "entries", "refusals", "checked", "vectors", "cache", "page", "webassembly",
        "processes",
    )
]  # fmt: skip

# mutation: (file below src/model/compile, what stands there once, what is put in its place)
MUTATIONS = {
    # --- arithmetic
    "differences are sums": ("arithmetic.py", 'ast.Sub: "sub"', 'ast.Sub: "add"'),
    "shifts to the right fill with zeros": ("arithmetic.py", '"ashr"', '"lshr"'),
    "<= is <": ("arithmetic.py", 'ast.LtE: "le"', 'ast.LtE: "lt"'),
    "powers have a factor more": ("arithmetic.py", "if count % 2 else", "if count % 4 else"),
    "quotients round up": ("arithmetic.py", 'code.compare("lt", code.integers("xor"', 'code.compare("gt", code.integers("xor"'),
    "exact quotients are one less": ("arithmetic.py", 'code.compare("ne", rest, constant(0))', "constant(True)"),
    "a known 0 divides": ("arithmetic.py", "known_number(bottom) == 0", "known_number(bottom) == 1"),
    "-0.0 is lost": ("arithmetic.py", "fneg{code.contract} double {number.name}", "fsub{code.contract} double 0.0, {number.name}"),
    "negative ints are positive": ("arithmetic.py", 'code.integers("sub", constant(0), number)', "number"),
    "what is known decides wrongly": ("arithmetic.py", "return rest if known", "return known if known"),
    "None is everything": ("arithmetic.py", "return all(is_none)", "return True"),
    # --- functions of Python
    "min takes the later of equals": ("builtins.py", 'min: _extreme("lt")', 'min: _extreme("le")'),
    "NaN beats numbers": ("builtins.py", "code.compare(how, b, a), b, a", "code.compare(how, a, b), a, b"),
    "numbers are NaN": ("builtins.py", "fcmp uno", "fcmp ord"),
    "infinity is finite": ("builtins.py", 'return code.compare("lt", code.intrinsic', 'return code.compare("le", code.intrinsic'),
    "abs is as it was": ("builtins.py", "call i64 @llvm.abs.i64(i64 {number.name}, i1 false)", "add i64 {number.name}, 0"),
    "reversed is as it was": ("builtins.py", "lasting_items(code, value)[::-1]", "lasting_items(code, value)"),
    "fetch_add replaces": ("builtins.py", "atomicrmw add", "atomicrmw xchg"),
    "vectors are one number long": ("builtins.py", "part_of(code, block, [each]).pointer", "code.address(block, each)"),
    "all is any": ("builtins.py", 'all: _several("and")', 'all: _several("or")'),
    # --- code
    "True is -1": ("code.py", "zext i1 {} to i64", "sext i1 {} to i64"),
    "ints have no sign": ("code.py", "sitofp i64 {} to double", "uitofp i64 {} to double"),
    "NaN counts as false": ("code.py", "fcmp une double {}, 0.0", "fcmp one double {}, 0.0"),
    "NaN is equal": ("code.py", "'une' if how == 'ne'", "'one' if how == 'ne'"),
    "comparisons have no sign": ("code.py", "f's{how}'", "f'u{how}'"),
    "operations are always fused": ("code.py", '" contract" if declared.contract else ""', '" contract"'),
    "sums may be reordered": ("code.py", '" contract" if declared.contract', '" reassoc contract" if declared.contract'),
    "NaN may be ignored": ("code.py", '" contract" if declared.contract', '" nnan contract" if declared.contract'),
    "the other is selected": ("code.py", "{a.kind} {a.name}, {b.kind} {b.name}", "{a.kind} {b.name}, {b.kind} {a.name}"),
    "a part has an element more": ("code.py", 'self.compare("lt", n, count)', 'self.compare("le", n, count)'),
    "constants lie by columns": ("code.py", "known.ravel().tolist()", 'known.ravel("F").tolist()'),
    # --- values and items
    "known zeros are the same": ("values.py", "(type(known), repr(known)) if", "known if"),
    "any types meet": ("values.py", "if one != other:", "if False:"),
    "parts of records are arrays": ("values.py", "any(each % array.itemsize for each in array.strides)", "False"),
    "strides are 1": ("items.py", "if stride == 1", "if stride"),
    "the first item is the last": ("items.py", "range(len(items) - 2, -1, -1)", "range(len(items) - 2, 0, -1)"),
    "an item beyond the last": ("items.py", "-length <= index < length", "-length <= index <= length"),
    "slices end beyond": ("items.py", 'code.select(code.compare("lt", number, count), number, count)', "number"),
    "slices do not count from the end": ("items.py", "if known is None or known < 0", "if False"),
    "slices backwards": ("items.py", "_larger(code, count, constant(0))", "count"),
    "no index is checked": ("items.py", "if is_known or not code.declared.checked", "if True"),
    "what lies beyond is written": ("items.py", "if isinstance(inside, Number)", "if False"),
    "negative indices are inside": ("code.py", "icmp ult i64 {index.name}", "icmp slt i64 {index.name}"),
    "_replace does nothing": ("items.py", "named.get(name, item)", "item"),
    "classes have no attributes": ("items.py", "if name in vars(value.made_by or object)", "if False"),
    # --- expressions, variables, statements
    "and, or: what is known": ("expressions.py", "truth.object != stops", "truth.object == stops"),
    "and is or": ("expressions.py", "(end, following) if stops", "(following, end) if stops"),
    "a chain holds if one does": ("expressions.py", 'both(self.code, "and", found, here), right', 'both(self.code, "or", found, here), right'),
    "in all": ("expressions.py", 'both(self.code, "or"', 'both(self.code, "and"'),
    "the other choice": ("expressions.py", "code.branch(truth, yes, no)", "code.branch(truth, no, yes)"),
    "types of ways are not compared": ("variables.py", "all(each == variable.type for each in found)", "True"),
    "names of some ways": ("variables.py", "if len(found) == len(others) and all", "if all"),
    "a round changes types": ("variables.py", "if name not in after or after[name].type != variable.type", "if False"),
    "variables never change": ("variables.py", "if name in self._unchanging", "if True"),
    "ranges count up": ("translate.py", '"lt" if by > 0 else "gt"', '"lt"'),
    "break continues": ("translate.py", "self._lead(loop.end, loop.at_end)", "self._lead(loop.following, loop.at_following)"),
    "results of any type": ("translate.py", "if self._result not in (None, type_)", "if False"),
    "items of a loop never change": ("source.py", "isinstance(loop, ast.For) and not", "False and not"),
    "arguments never change": ("source.py", "    names.update(arguments)\n", ""),
    # --- functions of vectors, modules, entries
    "a round more of vectors": ("vector_code.py", '"icmp slt"', '"icmp sle"'),
    "a vector that was stored is old": ("vector_code.py", "        self.loaded[pointer, row] = value\n", ""),
    "False is passed as True": ("module.py", "icmp ne i64 {word}, 0", "icmp eq i64 {word}, 0"),
    "results are one word apart": ("module.py", "ptr %result, i64 {n}", "ptr %result, i64 {n + 1}"),
    "arrays that are read-only are written": ("entries.py", "not argument.flags.writeable", "False"),
    "bound numbers are forgotten": ("entries.py", "self._words.pack(*words)", "bytes(self._words.size)"),
    "the exported function is another": ("webassembly.py", ".index(entry.name)", ".index(entry.name) - 1"),
    # --- the cache
    "closures are the same": ("identity.py", "_told((held, known", "_told((known"),
    "constants do not count": ("identity.py", "str(own), *held]", "str(own)]"),
    "globals do not count": ("identity.py", "            yield known, name, value\n", ""),
    "parts stay as they were": ("module.py", "and not part.is_as_named(contract)", "and False"),
    "outsiders are known": ("identity.py", "return package in (_PACKAGE, *_LIBRARIES),", "return True,"),
    "an edited file is taken": ("source.py", "and _does_the_same(written, code)", ""),
    "a damaged file is loaded": ("cache.py", "if content[:_CHECKSUM] == _checksum(body)", "if body"),
    "all processors are the same": ("cache.py", '{written_for()} {platform', '{platform'),
    "compilers are the same": ("cache.py", "versions.encode() + _COMPILER", "versions.encode()"),
}  # fmt: skip


@pytest.mark.nightly
@pytest.mark.parametrize("mutation", MUTATIONS)
def test_a_test_catches_it(tmp_path: Path, mutation: str) -> None:
    assert_caught(run_on_copy(tmp_path, "compile", MUTATIONS[mutation], TESTS))


@pytest.mark.nightly
def test_without_a_mutation_no_test_fails(tmp_path: Path) -> None:
    run = run_on_copy(tmp_path, "compile", None, TESTS)
    assert run.returncode == pytest.ExitCode.OK, run.stdout + run.stderr
