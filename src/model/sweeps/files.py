"""Atomic writing of files, which are replaced when complete; reading of a user's texts."""

import codecs
import contextlib
import json
import secrets
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml


@contextlib.contextmanager
def atomic_write(target: Path) -> Iterator[Path]:
    """Yield the path of a temporary file, which replaces ``target`` when the block ends.

    If the block raises, ``target`` stays as it was and the temporary file is removed.

    Raises:
        OSError: the folder cannot be created or written.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f".{target.name}-{secrets.token_hex(4)}.part")
    part.touch(mode=0o666, exist_ok=False)  # less what the umask withholds
    try:
        yield part
        part.replace(target)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def check_encoding(path: Path) -> None:
    """Refuse a path that the netCDF library cannot be told.

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


def parse_yaml(text: str) -> Any:
    """Return what a YAML text states, by libyaml where it is there: in a seventh of the time."""
    return yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506 - both safe


def write_text(text: str, path: Path) -> None:
    """Write ``text`` atomically."""
    with atomic_write(path) as part:
        part.write_text(text, encoding="utf-8")


def write_json(record: Mapping[str, Any], path: Path) -> None:
    """Write ``record`` as JSON, atomically."""
    write_text(json.dumps(record, indent=1, sort_keys=True) + "\n", path)
