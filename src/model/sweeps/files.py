"""Atomic writing of files, which are replaced when complete; reading of a user's texts."""

import codecs
import contextlib
import json
import re
import secrets
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml


@contextlib.contextmanager
def atomic_write(target: Path) -> Iterator[Path]:
    """Yield the path of a temporary file, which replaces ``target`` when the block ends.

    If the block raises, ``target`` stays as it was and the temporary file is removed. A link stays
    a link: what it points to is replaced.

    Raises:
        OSError: the folder cannot be created or written; it names ``target``.
    """
    real = target.resolve() if target.is_symlink() else target
    part = real.with_name(f".{secrets.token_hex(8)}.part")  # also beside the longest name
    try:
        real.parent.mkdir(parents=True, exist_ok=True)
        part.touch(mode=0o666, exist_ok=False)  # less what the umask withholds
        yield part
        part.replace(real)
    except BaseException as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename in (None, part, str(part)):
            raise OSError(error.errno, error.strerror or str(error), str(target)) from None
        raise


def check_encoding(path: Path) -> None:
    """Refuse a path that cannot be passed to the netCDF library.

    Raises:
        ValueError: Python takes the names of files for ASCII, and this one is not.
    """
    try:
        str(path.absolute()).encode(sys.getfilesystemencoding())
    except UnicodeEncodeError:
        raise ValueError(
            f"{str(path)!a}: Python takes the names of files for ASCII here: set PYTHONUTF8=1"
        ) from None


def read_text(path: Path) -> str:
    """Return the text of a file, in UTF-8, or in UTF-16 with its byte order mark.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is no such text; the message names the line.
    """
    content = path.read_bytes()
    wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        return content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise ValueError(f"line {line} is not UTF-8 text: save the file as UTF-8") from None


# By libyaml where it is there: in a seventh of the time.
Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_MISREAD = re.compile(r"[-+]?0[0-7_]+|[-+]?\d+(?::[0-5]?\d)+(?:\.\d*)?")  # 050 is 40, 1:30 is 90


def parse_yaml(text: str, loader: Any = Loader) -> Any:
    """Return what a YAML text states.

    Raises:
        ValueError: it is no YAML, states a key twice, or has a number that YAML takes for another.
    """
    reader = loader(text)
    try:
        node = reader.get_single_node()
        _check(node)
        return None if node is None else reader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line if error.problem_mark else 0
        if "\t" not in "".join(text.splitlines()[line : line + 1]):
            raise
        words = "has a tab, which YAML refuses: write spaces"
        raise ValueError(f"line {line + 1} {words}") from None
    finally:
        reader.dispose()


def _check(node: Any) -> None:
    """Refuse keys given twice, and numbers of base 8 or 60."""
    if isinstance(node, yaml.ScalarNode):
        if node.tag.endswith((":int", ":float")) and _MISREAD.fullmatch(node.value):
            line = node.start_mark.line + 1
            raise ValueError(
                f"line {line}: YAML takes {node.value} for a number of base 8 or 60: write a "
                "decimal number, without zeros before it"
            )
    elif isinstance(node, yaml.MappingNode):
        seen = set()
        for key, value in node.value:
            name = str(key.value)
            if name in seen:
                raise ValueError(f"line {key.start_mark.line + 1}: {name}: given twice")
            seen.add(name)
            _check(value)
    elif node is not None:
        for each in node.value:
            _check(each)


def write_text(text: str, path: Path) -> None:
    """Write ``text`` atomically."""
    with atomic_write(path) as part:
        part.write_text(text, encoding="utf-8")


def write_json(record: Mapping[str, Any], path: Path) -> None:
    """Write ``record`` as JSON, atomically."""
    write_text(json.dumps(record, indent=1, sort_keys=True) + "\n", path)
