"""The engine of a page as WebAssembly, run without a browser."""

import ctypes
from typing import Any

import numpy as np

MOST_ROWS = 20_000


class Browser:
    """A module as the page runs it: the memory, the stack and the C library's functions."""

    def __init__(self, binary: bytes, interface: dict[str, Any]) -> None:
        import wasmtime  # noqa: PLC0415  (not every environment has it)

        config = wasmtime.Config()
        config.cache = True  # to compile a module takes longer than to run the sets
        store = wasmtime.Store(wasmtime.Engine(config))
        module = wasmtime.Module(store.engine, binary)
        wanted = {each.name: each.type for each in module.imports}
        number = wasmtime.ValType.f64()
        libm = ctypes.CDLL(None)
        imports = []
        self.functions = set()
        for each, kind in wanted.items():
            if each == "__linear_memory":
                self.memory = wasmtime.Memory(store, wasmtime.MemoryType(wasmtime.Limits(1, None)))
                imports.append(self.memory)
            elif each == "__stack_pointer":
                value = wasmtime.Val.i32(interface["stack"])
                imports.append(wasmtime.Global(store, kind, value))
            elif isinstance(kind, wasmtime.FuncType):
                self.functions.add(each)
                function = libm[each]
                function.restype = ctypes.c_double
                function.argtypes = [ctypes.c_double] * len(kind.params)
                assert list(map(str, [*kind.params, *kind.results])) == [str(number)] * (
                    len(kind.params) + 1
                )
                imports.append(wasmtime.Func(store, kind, function))
            else:
                raise AssertionError(f"the module imports {each}, which no page gives it")
        exports = wasmtime.Instance(store, module, imports).exports(store)
        self.call, self.store, self.about = exports["run"], store, interface

    def run(self, sets: np.ndarray, rows: int = MOST_ROWS, **control: float) -> tuple[Any, Any]:
        """Return the results of the sets, and the track, of ``rows`` rows, of the only one."""
        chosen = {"sets": len(sets), "rows": rows}
        layout, stack = (self.about[it] for it in ("arguments", "stack"))
        lengths = [chosen.get(each["length"], each["length"]) for each in layout]
        sizes = [length * each["size"] for each, length in zip(layout, lengths, strict=True)]
        # The result of the call, its words, and the arrays, each from a new cache line on.
        places = stack + 8 * np.cumsum([0, *(-(-n // 8) * 8 for n in (1, 2 * len(layout), *sizes))])
        missing = int(places[-1]) - self.memory.data_len(self.store)
        if missing > 0:
            self.memory.grow(self.store, -(-missing // 65536))
        result, words, *arrays = map(int, places[:-1])
        self.memory.write(self.store, bytes(int(places[-1]) - words), words)
        self.memory.write(self.store, np.column_stack([arrays, lengths]).tobytes(), words)
        settings = dict(zip(self.about["limits"], self.about["defaults"], strict=True)) | control
        at = {each["name"]: n for n, each in enumerate(layout)}
        self.memory.write(self.store, sets.tobytes(), arrays[at["given"]])
        limits = np.array([*settings.values()])
        self.memory.write(self.store, limits.tobytes(), arrays[at["limits"]])
        self.call(self.store, words, result)

        def found(name: str) -> np.ndarray:
            n = at[name]
            data = self.memory.read(self.store, arrays[n], arrays[n] + 8 * sizes[n])
            return np.frombuffer(bytes(data)).reshape(lengths[n], layout[n]["size"])

        return found("results"), found("memory.track")
