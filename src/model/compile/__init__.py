"""Compilation of Python functions: the subset, machine code, WebAssembly, cache."""
