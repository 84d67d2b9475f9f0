"""Passes that turn a kernel's bytecode into LLVM's intermediate code.

numba's own pipeline has twice as many and analyses a function anew after most of them. For kernels
the intermediate code is the same to the letter, a fifth sooner (docs/decisions/0025-compiling.md).
"""

from types import CodeType

from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager
from numba.core.typed_passes import (
    AnnotateTypes,
    IRLegalization,
    NativeLowering,
    NoPythonBackend,
    NopythonTypeInference,
    PreLowerStripPhis,
)
from numba.core.untyped_passes import (
    DeadBranchPrune,
    FixupArgs,
    GenericRewrites,
    IRProcessing,
    ReconstructSSA,
    RewriteSemanticConstants,
    TranslateByteCode,
)

_PASSES = (
    TranslateByteCode,
    FixupArgs,
    IRProcessing,
    RewriteSemanticConstants,
    DeadBranchPrune,
    GenericRewrites,
    DeadBranchPrune,
    ReconstructSSA,
    DeadBranchPrune,
    NopythonTypeInference,
    PreLowerStripPhis,
    IRLegalization,
    AnnotateTypes,
    NativeLowering,
    NoPythonBackend,
)


class _Passes(PassManager):
    """Passes of a kernel, without numba's analysis after every pass that may change the code."""

    _ENFORCING = False


class KernelCompiler(Compiler):
    """numba's compiler with few passes; with all for a function that defines others inside."""

    def define_pipelines(self) -> list[PassManager]:
        """Return the pipeline, as a list of one."""
        if any(isinstance(each, CodeType) for each in self.state.func_id.code.co_consts):
            return super().define_pipelines()  # a comprehension, too, may be such a function
        few = _Passes("nopython")
        for each in _PASSES:
            few.add_pass(each, each.__name__)
        few.finalize()
        return [few]
