"""What ``fault_shim.c`` does, by Python's own functions: where there is no C compiler.

It sees the calls of the program, not those of C libraries; the program's writers use none.
"""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

FAIL, KILL, KILL_ON = 1, 2, 3


class Double:
    """Has the functions of the library."""

    def __init__(self) -> None:
        self.root, self.at, self.count, self.action, self.number = "", -1, 0, 0, 0
        self.without_exchange, self.journal, self.full = False, -1, False
        self._write, self._link = os.write, os.readlink
        self._put_in()

    def fault_arm(self, folder: bytes, call: int, action: int, number: int, cannot: int, log: int) -> None:
        self.root, self.at, self.action, self.number = os.fsdecode(folder), call, action, number
        self.without_exchange, self.journal, self.count, self.full = bool(cannot & 1), log, 0, False

    def fault_count(self) -> int:
        return self.count

    def path_of(self, target: Any, folder: int | None = None) -> str:
        if isinstance(target, int):
            try:
                return self._link(f"/proc/self/fd/{target}")
            except OSError:
                return ""
        base = os.getcwd() if folder is None else self.path_of(folder)  # noqa: PTH109 - Path is what is disturbed
        return os.path.join(base, os.fsdecode(target))  # noqa: PTH118

    def decide(self, path: str, *, takes_room: bool = False) -> None:
        if not self.root or not path.startswith(self.root):
            return
        self.count += 1
        if self.full and takes_room:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        if self.count != self.at and not (self.action == KILL_ON and self.count > self.at > 0):
            return
        if self.action in (KILL, KILL_ON):
            os.kill(os.getpid(), self.number)
        elif self.action == FAIL:
            self.full = self.number == errno.ENOSPC
            raise OSError(self.number, os.strerror(self.number))

    def record(self, call: str, one: str, other: str = "", data: bytes = b"") -> None:
        if self.journal >= 0 and self.root and one.startswith(self.root):
            self._write(self.journal, f"{call}\t{one}\t{other}\t{self.count}\t{len(data)}\n".encode() + data)

    def _put_in(self) -> None:
        system: Any = os
        for name, call, takes_room in (
            ("mkdir", "mkdir", True), ("rmdir", "rmdir", False), ("unlink", "unlink", False),
            ("rename", "rename", False), ("replace", "rename", False), ("fsync", "fsync", True), ("close", "", False),
        ):  # fmt: skip
            setattr(system, name, self._disturbed(getattr(os, name), call, takes_room))
        system.open = self._opening(os.open)
        files: Any = io
        files.open = self._files(io.open)
        import elbowscrew.disk.placing as placing
        from elbowscrew.disk.syncing import exchange

        patched: Any = placing
        patched.exchange = self._exchanging(exchange)

    def _disturbed(self, real: Callable[..., Any], call: str, takes_room: bool) -> Callable[..., Any]:
        def disturbed(target: Any, *others: Any, **more: Any) -> Any:
            path = self.path_of(target, more.get("dir_fd") or more.get("src_dir_fd"))
            try:
                self.decide(path, takes_room=takes_room)
            except OSError:
                if not call:
                    real(target)
                raise
            done = None if call == "fsync" and self.root else real(target, *others, **more)
            if call:
                self.record(call, path, self.path_of(others[0]) if call == "rename" else "")
            return done

        return disturbed

    def _exchanging(self, real: Callable[[Path, Path], bool]) -> Callable[[Path, Path], bool]:
        def exchange(one: Path, other: Path) -> bool:
            if self.without_exchange:
                return False
            self.decide(self.path_of(one))
            done = real(one, other)
            if done:
                self.record("exchange", self.path_of(one), self.path_of(other))
            return done

        return exchange

    def _opening(self, real: Callable[..., int]) -> Callable[..., int]:
        def opening(target: Any, flags: int, *others: Any, **more: Any) -> int:
            path = self.path_of(target, more.get("dir_fd"))
            self.decide(path, takes_room=bool(flags & os.O_CREAT))
            handle = real(target, flags, *others, **more)
            if flags & os.O_CREAT:
                self.record("create", path)
            return handle

        return opening

    def _files(self, real: Callable[..., Any]) -> Callable[..., Any]:
        double = self

        class Disturbed(io.FileIO):
            def write(self, data: Any, /) -> int:
                path = double.path_of(self.fileno())
                double.decide(path, takes_room=True)
                double.record("write", path, data=bytes(data))
                return super().write(data)

        def opened(file: Any, mode: str = "r", *others: Any, **more: Any) -> Any:
            if mode not in ("xb", "wb") or isinstance(file, int):
                return real(file, mode, *others, **more)
            double.decide(double.path_of(file), takes_room=True)
            raw = Disturbed(file, mode)
            double.record("create", double.path_of(file))
            return io.BufferedWriter(raw)

        return opened
