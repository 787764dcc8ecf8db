/**
 * How the page's texts become a catalogue: wuchale finds them in the sources and keeps them in src/texts/en.po; each
 * other file there is a language. What is a text is said in texts/rules.js.
 */
import { readdirSync } from "node:fs";
import path from "node:path";
import { adapter } from "@wuchale/svelte";
import { pseudo, withPseudo } from "./texts/pseudo.js";
import { runtime, transform } from "./texts/transformer.js";

const folder = path.join(import.meta.dirname, "src", "texts");
const others = readdirSync(folder)
  .flatMap((name) => /^(.+)\.po$/.exec(name)?.slice(1) ?? [])
  .filter((name) => name !== "en");

const page = adapter({
  files: {
    include: ["src/**/*.svelte", "src/**/*.ts"],
    // generated for the protocol; and what goes into files of 3D Slicer
    ignore: ["src/core/protocol.ts", "src/core/marks/slicer_markups.ts", "src/texts/**"],
  },
  loader: "custom",
  storage: withPseudo,
  runtime,
});

export default {
  locales: ["en", ...others, pseudo],
  localesDir: "src/texts",
  logLevel: "warn",
  adapters: { page: { ...page, transform } },
};
