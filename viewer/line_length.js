/**
 * Fails where a line of the page's sources, scripts, tests or shaders is too long. One check for all kinds of files:
 * eslint reads neither shaders nor style sheets. `src/core/protocol.ts` is generated.
 */
import fs from "node:fs";
import path from "node:path";

const most = 120;
const folders = ["bench", "e2e", "src", "tests", "texts"];
const kinds = new Set([".css", ".frag", ".glsl", ".html", ".js", ".mjs", ".mts", ".svelte", ".ts", ".vert"]);
const generated = new Set(
  [["src", "core", "protocol.ts"], ["src", "texts", ".wuchale"], ["bench", "dist"]].map((parts) => path.join(...parts)),
);

function filesBelow(folder) {
  return fs.readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const name = path.join(folder, entry.name);
    if (generated.has(name)) {
      return [];
    }
    return entry.isDirectory() ? filesBelow(name) : [name];
  });
}

process.chdir(import.meta.dirname);
const above = fs.readdirSync(".", { withFileTypes: true }).filter((entry) => entry.isFile());
const all = [...above.map(({ name }) => name), ...folders.flatMap(filesBelow)];
const files = all.filter((name) => kinds.has(path.extname(name)));
const long = files.flatMap((name) => {
  const lines = fs.readFileSync(name, "utf-8").split("\n");
  return lines.flatMap((line, i) => {
    const { length } = [...line];
    return length > most ? [`${name}:${String(i + 1)}: ${String(length)} characters, at most ${String(most)}`] : [];
  });
});
for (const sentence of long) {
  console.error(sentence);
}
process.exitCode = long.length === 0 ? 0 : 1;
