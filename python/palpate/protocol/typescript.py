"""Writes the page's side of the protocol, TypeScript, from the schema in this package.

``python -m palpate.protocol.typescript`` writes ``viewer/src/core/protocol.ts`` of the source tree:
one interface per message, and a checker that accepts only messages of the schema. A test fails
where the checked-in file and this module's output differ.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
import types
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

import msgspec

from palpate import protocol
from palpate.protocol import types as protocol_types

__all__ = ["OUTPUT", "generate"]

OUTPUT = Path(__file__).resolve().parents[3] / "viewer" / "src" / "core" / "protocol.ts"
"""Path of the generated file in the source tree."""

HEADER = """\
/**
 * Messages between engine and page, and the check of what arrives.
 *
 * Generated from `python/palpate/protocol/` by `python -m palpate.protocol.typescript`;
 * change it there. Each message is one msgpack map with a `type`. Points and vectors are
 * (x, y, z) in the scene frame, LPS [mm]; forces [N]; stiffness [N/mm]; times [s].
 */
import { decode, encode } from "@msgpack/msgpack";
"""

CHECKER = """\
/** A message that is not of the schema; says where and what was expected. */
export class ProtocolError extends Error {
  override name = "ProtocolError";
}

/** Unpacks a message of the engine; throws ProtocolError where it is not of the schema. */
export function decodeToPage(packed: ArrayBuffer | Uint8Array): ToPage {
  return checkToPage(unpack(packed));
}

/** Returns an unpacked message as what it is; throws ProtocolError where it is none. */
export function checkToPage(value: unknown): ToPage {
  const type = (value as { type?: unknown } | null | undefined)?.type;
  const check = typeof type === "string" ? TO_PAGE.get(type) : undefined;
  if (check === undefined) {
    throw new ProtocolError(`type: expected one of ${[...TO_PAGE.keys()].join(", ")}`);
  }
  check(value, String(type));
  return value as ToPage;
}

/** Packs a message for the engine. */
export function encodeFromPage(message: FromPage): Uint8Array<ArrayBuffer> {
  return encode(message);
}

function unpack(packed: ArrayBuffer | Uint8Array): unknown {
  try {
    return decode(packed);
  } catch (error) {
    throw new ProtocolError(`not msgpack: ${String(error)}`);
  }
}

/** Throws where a value is not as described; `path` names its place in the message. */
type Check = (value: unknown, path: string) => void;

interface Bounds {
  readonly ge?: number;
  readonly gt?: number;
  readonly le?: number;
  readonly lt?: number;
}

function expect(holds: boolean, path: string, expected: string): void {
  if (!holds) {
    throw new ProtocolError(`${path}: expected ${expected}`);
  }
}

function within(value: number, bounds: Bounds): boolean {
  const { ge = -Infinity, gt = -Infinity, le = Infinity, lt = Infinity } = bounds;
  return value >= ge && value > gt && value <= le && value < lt;
}

function real(bounds: Bounds = {}): Check {
  const expected = `a finite number ${JSON.stringify(bounds)}`;
  return (value, path) => {
    expect(Number.isFinite(value) && within(value as number, bounds), path, expected);
  };
}

function whole(bounds: Bounds = {}): Check {
  const expected = `a whole number ${JSON.stringify(bounds)}`;
  return (value, path) => {
    expect(Number.isInteger(value) && within(value as number, bounds), path, expected);
  };
}

function text(bounds: Bounds = {}): Check {
  const expected = `a text of length ${JSON.stringify(bounds)}`;
  return (value, path) => {
    expect(typeof value === "string" && within([...value].length, bounds), path, expected);
  };
}

const flag: Check = (value, path) => {
  expect(typeof value === "boolean", path, "true or false");
};

const bytes: Check = (value, path) => {
  expect(value instanceof Uint8Array, path, "bytes");
};

function oneOf(...allowed: readonly string[]): Check {
  return (value, path) => {
    expect(allowed.includes(value as string), path, `one of ${allowed.join(", ")}`);
  };
}

function nullable(check: Check): Check {
  return (value, path) => {
    if (value !== null) {
      check(value, path);
    }
  };
}

function list(check: Check): Check {
  return (value, path) => {
    expect(Array.isArray(value), path, "a list");
    (value as unknown[]).forEach((item, i) => {
      check(item, `${path}[${String(i)}]`);
    });
  };
}

function tuple(...checks: readonly Check[]): Check {
  return (value, path) => {
    expect(Array.isArray(value), path, "a list");
    const items = value as unknown[];
    expect(items.length === checks.length, path, `${String(checks.length)} items`);
    checks.forEach((check, i) => {
      check(items[i], `${path}[${String(i)}]`);
    });
  };
}

/** A map with exactly these fields. */
function record(fields: Readonly<Record<string, Check>>): Check {
  const names = Object.keys(fields);
  return (value, path) => {
    expect(typeof value === "object" && value !== null && !Array.isArray(value), path, "a map");
    const given = value as Readonly<Record<string, unknown>>;
    const extra = Object.keys(given).filter((name) => !Object.hasOwn(fields, name));
    expect(extra.length === 0, path, `no field ${extra.join(", ")}`);
    for (const name of names) {
      fields[name]?.(given[name], `${path}.${name}`);
    }
  };
}
"""


def generate() -> str:
    """Returns the text of ``protocol.ts``."""
    to_page, from_page = get_args(protocol.ToPage), get_args(protocol.FromPage)
    structs = list(_with_parts((*to_page, *from_page)))
    parts = [
        HEADER,
        f"export const PROTOCOL_VERSION = {protocol.PROTOCOL_VERSION};\n",
        *(_alias(name, doc) for name, doc in _documented_aliases()),
        *(_interface(struct) for struct in structs),
        _union("ToPage", "A message of the engine.", to_page),
        _union("FromPage", "A message of the page.", from_page),
        CHECKER,
        *_checks(to_page),
    ]
    return "\n".join(parts)


# --- what the schema holds --------------------------------------------------------------


def _with_parts(structs: tuple[Any, ...]) -> Iterator[Any]:
    """Yields the structs and those they consist of, each once and after its parts."""
    seen: set[Any] = set()

    def visit(hint: object) -> Iterator[Any]:
        if isinstance(hint, type) and issubclass(hint, msgspec.Struct):
            if hint in seen:
                return
            seen.add(hint)
            for part in _fields(hint).values():
                yield from visit(part)
            yield hint
        else:
            for part in get_args(hint):
                yield from visit(part)

    for struct in structs:
        yield from visit(struct)


def _fields(struct: type[msgspec.Struct]) -> dict[str, Any]:
    """Maps a struct's fields, in order, to their type hints, which may be of any form."""
    hints = get_type_hints(struct, include_extras=True)
    return {name: hints[name] for name in struct.__struct_fields__}


def _documented_aliases() -> list[tuple[str, str]]:
    """Lists the schema's named types with the docstring of each."""
    body = ast.parse(inspect.getsource(protocol_types)).body
    aliases = []
    for statement, after in pairwise(body):
        match statement, after:
            case ast.Assign(targets=[ast.Name(name)]), ast.Expr(ast.Constant(str(doc))):
                aliases.append((name, doc))
    return aliases


def _alias_of(hint: object) -> str | None:
    """Returns the name of the schema's type that equals this hint, if there is one."""
    names = (name for name, _ in _documented_aliases())
    return next((name for name in names if getattr(protocol_types, name) == hint), None)


def _bounds(meta: msgspec.Meta) -> dict[str, float]:
    """Returns the bounds of a number, or of the length of a string."""
    ends = {"ge": meta.ge, "gt": meta.gt, "le": meta.le, "lt": meta.lt}
    ends["ge"] = meta.min_length if meta.min_length is not None else ends["ge"]
    ends["le"] = meta.max_length if meta.max_length is not None else ends["le"]
    return {name: end for name, end in ends.items() if end is not None}


# --- one walk over a type, written in two ways ------------------------------------------


@dataclass(frozen=True)
class Dialect:
    """How the parts of a type are written: as TypeScript types, or as checks."""

    leaves: dict[object, str]
    name: Callable[[str], str]
    bounded: Callable[[str, dict[str, float]], str]
    literal: Callable[[list[str]], str]
    row: Callable[[list[str]], str]
    many: Callable[[str], str]
    nullable: Callable[[str], str]


def _write(hint: object, dialect: Dialect, *, named: bool = True) -> str:
    """Returns a type in a dialect, by its name where it has one."""
    alias = _alias_of(hint) if named else None
    arguments = get_args(hint)
    if alias is not None:
        written = dialect.name(alias)
    elif hint in dialect.leaves:
        written = dialect.leaves[hint]
    elif isinstance(hint, type) and issubclass(hint, msgspec.Struct):
        written = dialect.name(hint.__name__)
    elif get_origin(hint) is Annotated:
        written = dialect.bounded(_write(arguments[0], dialect), _bounds(arguments[1]))
    elif get_origin(hint) is Literal:
        written = dialect.literal([f'"{value}"' for value in arguments])
    elif get_origin(hint) is tuple:
        written = dialect.row([_write(argument, dialect) for argument in arguments])
    elif get_origin(hint) is list:
        written = dialect.many(_write(arguments[0], dialect))
    elif len(arguments) == 2 and arguments[1] is types.NoneType:
        written = dialect.nullable(_write(arguments[0], dialect))
    else:
        raise TypeError(f"no way to write {hint!r}; allowed: the kinds that the messages have now")
    return written


def _many_types(item: str) -> str:
    return f"readonly {f'({item})' if item.startswith('readonly') else item}[]"


TYPES = Dialect(
    leaves={int: "number", float: "number", str: "string", bool: "boolean", bytes: "Uint8Array"},
    name=lambda name: name,
    bounded=lambda leaf, _: leaf,
    literal=" | ".join,
    row=lambda items: f"readonly [{', '.join(items)}]",
    many=_many_types,
    nullable=lambda item: f"{item} | null",
)


def _bounded_check(leaf: str, bounds: dict[str, float]) -> str:
    ends = ", ".join(f"{name}: {_number(end)}" for name, end in bounds.items())
    return leaf.replace("()", f"({{ {ends} }})")


CHECKS = Dialect(
    leaves={int: "whole()", float: "real()", str: "text()", bool: "flag", bytes: "bytes"},
    name=lambda name: f"is{name}",
    bounded=_bounded_check,
    literal=lambda values: f"oneOf({', '.join(values)})",
    row=lambda items: f"tuple({', '.join(items)})",
    many=lambda item: f"list({item})",
    nullable=lambda item: f"nullable({item})",
)


def _number(value: float) -> str:
    return str(int(value)) if value == int(value) else repr(value)


# --- declarations -----------------------------------------------------------------------


def _alias(name: str, doc: str) -> str:
    written = _write(getattr(protocol_types, name), TYPES, named=False)
    return f"{_comment(doc)}export type {name} = {written};\n"


def _interface(struct: type[msgspec.Struct]) -> str:
    tag = struct.__struct_config__.tag
    lines = [f'  readonly type: "{tag}";'] if tag else []
    fields = _fields(struct).items()
    lines += [f"  readonly {name}: {_write(hint, TYPES)};" for name, hint in fields]
    body = "\n".join(lines)
    comment = _comment(inspect.getdoc(struct) or "")
    return f"{comment}export interface {struct.__name__} {{\n{body}\n}}\n"


def _union(name: str, doc: str, structs: tuple[Any, ...]) -> str:
    lines = "\n".join(f"  | {struct.__name__}" for struct in structs)
    return f"{_comment(doc)}export type {name} =\n{lines};\n"


def _comment(doc: str) -> str:
    """Returns a sentence or a docstring as a JSDoc comment."""
    lines = inspect.cleandoc(doc).replace("``", "`").splitlines()
    if len(lines) == 1:
        return f"/** {lines[0]} */\n"
    body = "\n".join(f" * {line}".rstrip() for line in lines)
    return f"/**\n{body}\n */\n"


def _checks(structs: tuple[Any, ...]) -> list[str]:
    """Writes the checks of what the engine sends, those of named types that they need first."""
    checks = [*(_check_of_struct(struct) for struct in _with_parts(structs)), _check_table(structs)]
    # a later name may stand on an earlier one
    for name, _ in reversed(_documented_aliases()):
        if any(re.search(rf"\bis{name}\b", check) for check in checks):
            checks.insert(0, _check_of_alias(name))
    return checks


def _check_of_alias(name: str) -> str:
    check = _write(getattr(protocol_types, name), CHECKS, named=False)
    return f"const {CHECKS.name(name)} = {check};\n"


def _check_of_struct(struct: type[msgspec.Struct]) -> str:
    tag = struct.__struct_config__.tag
    lines = [f'  type: oneOf("{tag}"),'] if tag else []
    lines += [f"  {name}: {_write(hint, CHECKS)}," for name, hint in _fields(struct).items()]
    body = "\n".join(lines)
    return f"const {CHECKS.name(struct.__name__)} = record({{\n{body}\n}});\n"


def _check_table(structs: tuple[Any, ...]) -> str:
    lines = "\n".join(
        f'  ["{struct.__struct_config__.tag}", {CHECKS.name(struct.__name__)}],'
        for struct in structs
    )
    return f"const TO_PAGE: ReadonlyMap<string, Check> = new Map([\n{lines}\n]);\n"


if __name__ == "__main__":
    OUTPUT.parent.mkdir(parents=True, exist_ok=True)
    OUTPUT.write_text(generate(), encoding="utf-8")
    sys.stdout.write(f"wrote {OUTPUT}\n")
