"""Names that stand in files: columns, keys, and variants of what the engine packs.

They are the format. Who renames a field or a variant in code keeps its old name here by
``#[serde(rename)]`` or msgspec's ``rename``, else files of versions before are read wrongly; where
a field has a default even without a word.
"""

from __future__ import annotations

import json
import zipfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

__all__ = [
    "keys_of",
    "names_of_files",
    "names_of_recording",
    "names_of_recordings",
    "names_of_scene",
]


def keys_of(value: Any, place: str = "", *, words: bool = False) -> set[str]:
    """Returns where names stand in what JSON or MessagePack tells; rows of a list count as one.

    ``words`` counts texts, too: those that the engine packs are names of variants.
    """
    found: set[str] = set()
    if words and isinstance(value, str):
        found.add(f"{place}={value}" if place else value)
    if isinstance(value, dict):
        for name, inner in value.items():
            here = f"{place}.{name}" if place else str(name)
            found |= {here} | keys_of(inner, here, words=words)
    elif isinstance(value, list):
        for inner in value:
            found |= keys_of(inner, f"{place}[]", words=words)
    return found


def names_of_recording(path: Path) -> dict[str, set[str]]:
    """Returns the names in a recording: of columns, of its start, of commands, about it."""
    with np.load(path, allow_pickle=False) as archive:
        columns = {name: archive[name] for name in archive.files}
    start = msgspec.msgpack.decode(columns["start"].tobytes())
    packed = columns["commands"].tobytes()
    ends = [0, *map(int, columns["command_ends"])]
    commands = [msgspec.msgpack.decode(packed[low:high]) for low, high in pairwise(ends)]
    return {
        "recording columns": set(columns),
        "recording about": keys_of(json.loads(columns["about"].tobytes())),
        "recording start": keys_of(start, words=True),
        "recording commands": set().union(*(keys_of(one, words=True) for one in commands)),
    }


def names_of_recordings(fixtures: Path) -> dict[str, list[str]]:
    """Returns the names in all recordings that are kept."""
    return joined(names_of_recording(path) for path in sorted((fixtures / "recordings").iterdir()))


def joined(each: Any) -> dict[str, list[str]]:
    """Returns the names of several files together, in their order."""
    found: dict[str, set[str]] = {}
    for names in each:
        for kind, some in names.items():
            found[kind] = found.get(kind, set()) | some
    return {kind: sorted(some) for kind, some in found.items()}


def names_of_scene(path: Path) -> dict[str, set[str]]:
    """Returns the names in a scene: its members, and the keys of what it says of itself."""
    with zipfile.ZipFile(path) as archive:
        about = json.loads(archive.read("scene.json"))
        members = set(archive.namelist())
    # how pages keep their view is theirs
    view = dict.fromkeys(about["view"] or {})
    return {"scene members": members, "scene keys": keys_of({**about, "view": view})}


def names_of_state(folder: Path) -> dict[str, set[str]]:
    """Returns the names in the state folder: its files, and the keys in these."""
    found: dict[str, set[str]] = {"state files": set()}
    for path in sorted(folder.rglob("*")):
        if path.suffix in (".json", ".second"):
            name = path.name if path.suffix == ".json" else "journal.second"
            found["state files"] |= {name}
            found[f"state {name}"] = keys_of(json.loads(path.read_bytes()))
    return found


def names_of_files(files: Path) -> dict[str, list[str]]:
    """Returns the names in scenes, notes and runs that are kept."""
    run = {"scenario": keys_of(json.loads((files / "needle.json").read_text("utf-8")))}
    scenes = [names_of_scene(path) for path in sorted(files.glob("*.palpate"))]
    return joined([*scenes, names_of_state(files / "state"), run])
