"""Passes that turn a kernel's bytecode into LLVM's intermediate code.

numba has twice as many and analyses a function anew after most of them. With these, kernels have
the same intermediate code to the letter, in 0.9 of the time (docs/decisions/0025-compiling.md).
"""

from types import CodeType

from numba.core import typed_passes, untyped_passes
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager

_PASSES = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.RewriteSemanticConstants,
    untyped_passes.DeadBranchPrune,
    untyped_passes.GenericRewrites,
    untyped_passes.DeadBranchPrune,
    untyped_passes.ReconstructSSA,
    untyped_passes.DeadBranchPrune,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.IRLegalization,
    typed_passes.AnnotateTypes,
    typed_passes.NativeLowering,
    typed_passes.NoPythonBackend,
)


class _Passes(PassManager):
    """Passes of a kernel, without numba's analysis after every pass that may change the code."""

    _ENFORCING = False


class KernelCompiler(Compiler):
    """numba's compiler with these passes; a function that defines others takes numba's own."""

    def define_pipelines(self) -> list[PassManager]:
        """Return the pipeline, as a list of one."""
        if any(isinstance(each, CodeType) for each in self.state.func_id.code.co_consts):
            return super().define_pipelines()  # a comprehension may be such a definition
        few = _Passes("nopython")
        for each in _PASSES:
            few.add_pass(each, each.__name__)
        few.finalize()
        return [few]
