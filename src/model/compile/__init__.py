"""Compilation of Python functions: numba kernels, generated sources, WebAssembly, cache."""
