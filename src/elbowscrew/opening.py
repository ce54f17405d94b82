"""Files opened as what they should be: regular ones to read, new ones to write, and never what a link leads to.

All files of others are read by way of this module, and all of ours written: a pipe would keep a reader waiting for
ever, and a link in the output lead a writer to somebody else's file.
"""

from __future__ import annotations

import errno
import hashlib
import io
import os
import stat
import tomllib
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Final

# Not all systems have all of them.
_AT_ONCE: Final[int] = getattr(os, "O_NONBLOCK", 0)
_NO_LINK: Final[int] = getattr(os, "O_NOFOLLOW", 0)

_LARGEST: Final = 100_000_000
_LARGEST_TOML: Final = 1_000_000


def open_bytes(path: Path) -> io.BufferedReader:
    """Open a file to read its bytes.

    Raises
    ------
    OSError
        If it cannot be opened, or is a pipe, a socket or a device: none of these is waited for.
    """
    _check_regular(path.stat().st_mode)  # a device is not even opened
    return open(path, "rb", opener=partial(_open_regular, more=_AT_ONCE))


def sha256_of(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal digits.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    with open_bytes(path) as stream:
        return digest_of(stream)


def digest_of(stream: io.BufferedReader) -> str:
    """SHA-256 of what is left of a stream, in hexadecimal digits."""
    return hashlib.file_digest(stream, "sha256").hexdigest()


def open_text(path: Path, encoding: str = "utf-8", newline: str | None = None) -> io.TextIOWrapper:
    """Open a file to read its text; as `open_bytes`."""
    return io.TextIOWrapper(open_bytes(path), encoding=encoding, newline=newline)


def read_text(path: Path, encoding: str = "utf-8", largest: int = _LARGEST) -> str:
    """Read all text of a file; as `open_bytes`, and an error if it has more than so many bytes.

    Line ends become those of Python.

    Raises
    ------
    OSError
        As `open_bytes`, and if the file is larger.
    UnicodeDecodeError
        If it is not text.
    """
    return _decoded(read_bytes(path, largest), encoding)


def read_bytes(path: Path, largest: int) -> bytes:
    """Read a file, and an error if it has more than so many bytes; as `open_bytes`.

    Raises
    ------
    OSError
        As `open_bytes`, and if the file is larger.
    """
    with open_bytes(path) as stream:
        size = min(os.fstat(stream.fileno()).st_size, largest)  # a buffer for more would be made at once
        content = stream.read(size + 1)
        if size < len(content) <= largest:  # it has grown
            content += stream.read(largest + 1 - len(content))
    if len(content) > largest:
        raise OSError(errno.EFBIG, f"it has over {largest} bytes")
    return content


def _decoded(content: bytes, encoding: str) -> str:
    return io.TextIOWrapper(io.BytesIO(content), encoding=encoding).read()


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file; as `read_toml_and_digest`."""
    return read_toml_and_digest(path)[0]


def read_toml_and_digest(path: Path) -> tuple[dict[str, Any], str]:
    """Read a TOML file, be it with a byte order mark, and take the SHA-256 of the same bytes.

    Raises
    ------
    OSError
        As `read_text`.
    ValueError
        If it is not TOML, or tables are in it deeper than anybody means.
    """
    content = read_bytes(path, _LARGEST_TOML)
    text = _decoded(content, "utf-8-sig")
    try:
        return tomllib.loads(text), hashlib.sha256(content).hexdigest()
    except RecursionError as error:
        msg = "tables or lists inside each other, too many of them"
        raise ValueError(msg) from error
    except tomllib.TOMLDecodeError:
        raise
    except ValueError as error:  # Python's own, which speaks to programmers
        msg = "a whole number of thousands of digits"
        raise ValueError(msg) from error


def create(path: Path) -> io.BufferedWriter:
    """Open a file to write that is not there yet; a link of its name is not followed.

    Raises
    ------
    OSError
        If there is anything of that name, or the disk does not take it.
    """
    return path.open("xb")


def write_new(path: Path, content: bytes) -> None:
    """Write a file that is not there yet; as `create`."""
    with create(path) as stream:
        stream.write(content)


def open_own(path: Path) -> io.BufferedRandom:
    """Open a file to read and write that is made if there is none; a link of its name is not followed.

    Raises
    ------
    OSError
        If it cannot be opened, is a link or no regular file, or is another file as well, by a hard link.
    """
    with suppress(FileNotFoundError):
        _check_regular(path.lstat().st_mode)
    stream = open(path, "a+b", opener=partial(_open_regular, more=_AT_ONCE | _NO_LINK))  # noqa: SIM115 - given on
    if os.fstat(stream.fileno()).st_nlink > 1:
        stream.close()
        raise OSError(errno.EMLINK, f"{path.name} is a link to another file")
    return stream


def _open_regular(name: str, flags: int, more: int) -> int:
    """Open a file and look at what was opened, whatever may have come to its name since."""
    opened = os.open(name, flags | more, 0o666)
    try:
        _check_regular(os.fstat(opened).st_mode)
    except OSError:
        os.close(opened)
        raise
    return opened


def _check_regular(mode: int) -> None:
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if stat.S_ISLNK(mode):
        raise OSError(errno.ELOOP, "it is a link to another file")
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "it is no regular file")
