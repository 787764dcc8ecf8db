/**
 * The arrows between the viewer's rooms, as eslint rules: which folder may import which, that each arrow that is
 * allowed exists, and that none closes a circle. Paths are resolved, so that it does not matter how an import is
 * written.
 */
import fs from "node:fs";
import path from "node:path";

const source = path.join(import.meta.dirname, "src");

/** Parts of the path that name a room, by the folder below `src`. */
const depths = { core: 2, gl: 2, live: 1, ui: 2 };

/** The room of a file below `src`: "core/geometry", "core/protocol", "live", "ui/app", "ui/features/marks" … */
function roomOf(file) {
  const parts = file.split("/");
  const depth = file.startsWith("ui/features/") ? 3 : (depths[parts[0]] ?? 1);
  return parts.slice(0, depth).join("/").replace(/\..*$/, "");
}

function isFeature(room) {
  return room.startsWith("ui/features/");
}

/** The path below `src`, without its endings; null outside of `src`. */
function belowSource(file) {
  const below = path.relative(source, file).split(path.sep).join("/");
  return below.startsWith("..") ? null : below.replace(/\?.*$/, "");
}

/** The row of the table of rooms that tells what a room may import. */
function rowOf(room) {
  return isFeature(room) ? "ui/features" : room;
}

/** Whether an entry of a row allows a room: it names the room, or a folder that the room lies in. */
function allows(entry, room) {
  return room === entry || room.startsWith(`${entry}/`);
}

/** The arrow between two features as the table of features has it; null where it is another one. */
function featureArrow(here, there) {
  const name = (room) => room.slice("ui/features/".length);
  return isFeature(here) && isFeature(there) ? `${name(here)} -> ${name(there)}` : null;
}

/**
 * Why `from` may not import `to`; null where it may.
 *
 * @param {{ rooms: Record<string, string[]>, features: Record<string, string> }} allowed
 */
function refusal(from, to, { rooms, features }) {
  const [here, there] = [roomOf(from), roomOf(to)];
  if (here === there || here === "main") {
    return null;
  }
  const arrow = featureArrow(here, there);
  if (arrow !== null) {
    return arrow in features ? null : `a feature imports no other feature, and "${arrow}" is not listed with a reason`;
  }
  const open = rooms[rowOf(here)];
  if (open === undefined) {
    return `"${here}" is no room: src/ has ${Object.keys(rooms).join(", ")}`;
  }
  const may = `${here} may import ${open.length === 0 ? "nothing" : open.join(", ")}`;
  return open.some((entry) => allows(entry, there)) ? null : may;
}

/** The file below `src` that an import written in `file` means; null where it is a package or lies outside. */
function targetOf(file, written) {
  return written.startsWith(".") ? belowSource(path.resolve(path.dirname(file), written)) : null;
}

/** All arrows between rooms, as pairs of rooms. */
function arrowsOfSource() {
  const files = fs
    .readdirSync(source, { recursive: true, encoding: "utf-8" })
    .filter((name) => /\.(ts|svelte)$/.test(name));
  return files.flatMap((name) => {
    const file = path.join(source, name);
    const written = fs.readFileSync(file, "utf-8").matchAll(/(?:\bfrom|\bimport\(?)\s*"([^"]+)"/g);
    const targets = [...written].map((match) => targetOf(file, match[1])).filter((target) => target !== null);
    return targets.map((target) => [roomOf(belowSource(file)), roomOf(target)]);
  });
}

/** Entries of the tables that no import needs, as sentences. */
function unused({ rooms, features }) {
  const arrows = arrowsOfSource().filter(([here, there]) => here !== there);
  const found = new Set(arrows.map(([here, there]) => featureArrow(here, there)));
  const ofFeatures = Object.keys(features).filter((arrow) => !found.has(arrow));
  const isUsed = (row, entry) =>
    arrows.some(([here, there]) => rowOf(here) === row && featureArrow(here, there) === null && allows(entry, there));
  const ofRooms = Object.entries(rooms).flatMap(([row, entries]) =>
    entries.filter((entry) => !isUsed(row, entry)).map((entry) => `${row} -> ${entry}`),
  );
  return [...ofFeatures, ...ofRooms];
}

/** Entries of the table of rooms that name a room of a later row: they could close a circle. */
function upward({ rooms }) {
  const rows = Object.keys(rooms);
  return Object.entries(rooms).flatMap(([row, entries], place) =>
    entries
      .filter((entry) => rows.some((other, later) => later > place && allows(entry, other)))
      .map((entry) => `${row} -> ${entry}`),
  );
}

export const arrows = {
  meta: {
    type: "problem",
    docs: { description: "rooms import only the rooms below them" },
    messages: { wrong: "wrong arrow: {{from}} -> {{to}}: {{why}}" },
    schema: [{ type: "object" }],
  },
  create(context) {
    const from = belowSource(context.filename);
    if (from === null) {
      return {};
    }
    const check = (node) => {
      const written = node.source?.value ?? node.argument?.literal?.value;
      if (typeof written !== "string" || !written.startsWith(".")) {
        return;
      }
      const to = targetOf(context.filename, written);
      const why = to === null ? "it lies outside of src/" : refusal(from, to, context.options[0]);
      if (why !== null) {
        context.report({ node, messageId: "wrong", data: { from, to: to ?? written, why } });
      }
    };
    return {
      ImportDeclaration: check,
      ExportNamedDeclaration: check,
      ExportAllDeclaration: check,
      ImportExpression: check,
      TSImportType: check,
    };
  },
};

/** To be run on one file alone: it looks at all of them. */
export const arrowsInOrder = {
  meta: {
    type: "problem",
    docs: { description: "an arrow that is allowed exists, and goes down" },
    messages: {
      unused: 'no import needs "{{arrow}}": take it out of the list',
      upward: 'wrong arrow: "{{arrow}}" goes to a later row of the table',
    },
    schema: [{ type: "object" }],
  },
  create: (context) => ({
    Program(node) {
      for (const arrow of unused(context.options[0])) {
        context.report({ node, messageId: "unused", data: { arrow } });
      }
      for (const arrow of upward(context.options[0])) {
        context.report({ node, messageId: "upward", data: { arrow } });
      }
    },
  }),
};
