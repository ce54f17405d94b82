"""Power is cut: what was written but not synced is not there.

The calls of an undisturbed run are written down and played again on a model of the disk, up to every one of them. Then
the disk is put together as two kinds of file systems may leave it:

* ordered: names are as they were at that moment, and files that were not synced are empty;
* strict: names in a folder are as they were when that folder was last synced, and so are files.

In both the results must be the old ones or the new ones, and the next run must end as an undisturbed one. After the
last call nothing may be lost.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faults import Bench, Tally


@dataclass(eq=False)
class File:
    content: bytes = b""
    durable: bytes = b""


@dataclass(eq=False)
class Folder:
    names: dict[str, File | Folder] = field(default_factory=dict)
    durable: dict[str, File | Folder] = field(default_factory=dict)


class Disk:
    """Files and folders below a root, as they are and as they stand on the disk itself."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.top = _load(root)

    def play(self, call: str, one: str, other: str, data: bytes) -> None:
        folder, name = self._place(one)
        match call:
            case "create":
                folder.names.setdefault(name, File())
            case "write":
                file = folder.names[name]
                assert isinstance(file, File)
                file.content += data
            case "fsync":
                thing = folder.names[name] if name else self.top
                if isinstance(thing, File):
                    thing.durable = thing.content
                else:
                    thing.durable = dict(thing.names)
            case "mkdir":
                folder.names[name] = Folder()
            case "unlink" | "rmdir":
                del folder.names[name]
            case "rename":
                to, new = self._place(other)
                to.names[new] = folder.names.pop(name)
            case "exchange":
                to, new = self._place(other)
                folder.names[name], to.names[new] = to.names[new], folder.names[name]
            case _:
                raise ValueError(call)

    def _place(self, path: str) -> tuple[Folder, str]:
        *folders, name = Path(path).relative_to(self.root).parts or ("",)
        here = self.top
        for part in folders:
            inner = here.names[part]
            assert isinstance(inner, Folder)
            here = inner
        return here, name

    def put(self, place: Path, *, strict: bool) -> None:
        """Put together what is there after power was lost."""
        _put(self.top, place, strict)


def _load(path: Path) -> Folder:
    folder = Folder()
    for inner in path.iterdir():
        if inner.is_dir():
            folder.names[inner.name] = _load(inner)
        else:
            content = inner.read_bytes()
            folder.names[inner.name] = File(content, content)
    folder.durable = dict(folder.names)
    return folder


def _put(folder: Folder, place: Path, strict: bool) -> None:
    place.mkdir()
    for name, thing in (folder.durable if strict else folder.names).items():
        if isinstance(thing, Folder):
            _put(thing, place / name, strict)
        else:
            (place / name).write_bytes(thing.durable)


def calls_in(journal: Path) -> Iterator[tuple[str, str, str, bytes]]:
    """Read the calls that were written down."""
    for call, one, other, _, data in _lines_of(journal):
        yield call, one, other, data


def steps_in(journal: Path) -> list[int]:
    """Numbers of some calls by which something took its place, the last one among them, and of the next sync."""
    calls = [(call, number) for call, _, _, number, _ in _lines_of(journal)]
    moves = [number for call, number in calls if call in ("rename", "exchange")]
    synced = next(number for call, number in calls if call == "fsync" and number > moves[-1])
    return [moves[0], moves[len(moves) // 2], moves[-1], synced]


def _lines_of(journal: Path) -> Iterator[tuple[str, str, str, int, bytes]]:
    with journal.open("rb") as stream:
        while line := stream.readline():
            call, one, other, number, size = line.decode().rstrip("\n").split("\t")
            yield call, one, other, int(number), stream.read(int(size))


def cut_power(bench: Bench, scratch: Path, tally: Tally, *, step: int, sync_step: int) -> None:
    """Cut power during one scenario: at every `sync_step`-th sync, and at every `step`-th call."""
    from fault_scenarios import part_of, tree_of

    work, journal = bench.work, scratch / "journal"
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir()
    bench.begin()
    assert bench.run(journal=journal).code == 0
    calls = list(calls_in(journal))
    bench.begin()
    disk, syncs = Disk(work), 0
    for k, call in enumerate(calls):
        disk.play(*call)
        last = k == len(calls) - 1
        syncs += call[0] == "fsync"
        if not last and k % step and not (call[0] == "fsync" and syncs % sync_step == 0):
            continue
        for strict in (False, True):
            name, place = f"{bench.name}, power", f"{'strict' if strict else 'ordered'} after call {k}, {call[0]}"
            if tally.is_known(name, place):
                continue
            shutil.rmtree(work, ignore_errors=True)
            disk.put(work, strict=strict)
            tree, found = tree_of(work), []
            for part in bench.scenario.parts:
                now, was, will = (part_of(one, part) for one in (tree, bench.old, bench.new))
                pending = len(part) > 1 and (now.items() <= was.items() or now.items() <= will.items())
                known = now in (was, will) or pending or (not now and part[0] in bench.scenario.passing)
                if not known or (last and now != will):
                    found.append(f"{part[0]} is neither the old one nor the new one")
            tally.add(name, place, found + bench.faults_of_next_run(tree))
