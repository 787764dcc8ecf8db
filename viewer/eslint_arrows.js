/**
 * The arrows between the viewer's rooms, as an eslint rule: which folder may import which. Paths are resolved, so
 * that it does not matter how an import is written.
 */
import path from "node:path";

const source = path.join(import.meta.dirname, "src");

/** The room of a file below `src`: "core", "gl", "live", "ui/app", "ui/widgets", "ui/features/marks" … */
function roomOf(file) {
  const parts = file.split("/");
  const depth = parts[0] !== "ui" ? 1 : parts[1] === "features" ? 3 : 2;
  return parts.slice(0, depth).join("/");
}

function isFeature(room) {
  return room.startsWith("ui/features/");
}

/** The path below `src`, without its endings; null outside of `src`. */
function belowSource(file) {
  const below = path.relative(source, file).split(path.sep).join("/");
  return below.startsWith("..") ? null : below.replace(/\?.*$/, "");
}

/**
 * Why `from` may not import `to`; null where it may.
 *
 * @param {{ rooms: Record<string, string[]>, features: Record<string, string>, toOpen: Record<string, string[]> }} allowed
 */
function refusal(from, to, { rooms, features, toOpen }) {
  const [here, there] = [roomOf(from), roomOf(to)];
  if (here === there || here === "main.ts") {
    return null;
  }
  if (isFeature(here) && isFeature(there)) {
    const arrow = `${here.slice("ui/features/".length)} -> ${there.slice("ui/features/".length)}`;
    return arrow in features ? null : `a feature imports no other feature, and "${arrow}" is not listed with a reason`;
  }
  if (toOpen[to]?.includes(from) === true) {
    return null;
  }
  const open = rooms[isFeature(here) ? "ui/features" : here];
  if (open === undefined) {
    return `"${here}" is no room: src/ has ${Object.keys(rooms).join(", ")}`;
  }
  const room = isFeature(there) ? "ui/features" : there;
  return open.includes(room) ? null : `${here} may import ${open.length === 0 ? "nothing" : open.join(", ")}`;
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
      const target = node.source?.value ?? node.argument?.literal?.value;
      if (typeof target !== "string" || !target.startsWith(".")) {
        return;
      }
      const to = belowSource(path.resolve(path.dirname(context.filename), target));
      const why = to === null ? "it lies outside of src/" : refusal(from, to, context.options[0]);
      if (why !== null) {
        context.report({ node, messageId: "wrong", data: { from, to: to ?? target, why } });
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
