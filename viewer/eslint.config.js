/**
 * Lints of the viewer, and the arrows between its rooms: core imports nothing of the others; gl and live import core;
 * ui is app above features above widgets, theme and state.
 */
import js from "@eslint/js";
import svelte from "eslint-plugin-svelte";
import globals from "globals";
import ts from "typescript-eslint";
import { arrows, arrowsInOrder } from "./eslint_arrows.js";

/**
 * What each room of `src/` may import beside itself, from the ground up: only rooms of rows before it. A folder stands
 * for all rooms in it.
 */
const rooms = {
  "core/protocol": [],
  "core/geometry": ["core/protocol"],
  "core/base": ["core/geometry"],
  "core/library": ["core/base", "core/geometry"],
  "core/scenario": ["core/geometry"],
  "core/scan": ["core/geometry", "core/protocol"],
  "core/surfaces": ["core/geometry", "core/protocol"],
  "core/segments": ["core/base", "core/geometry", "core/protocol", "core/scan"],
  "core/tissue": ["core/base", "core/geometry", "core/protocol"],
  "core/tools": ["core/base", "core/geometry", "core/protocol"],
  "core/slices": ["core/base", "core/geometry", "core/protocol", "core/scan", "core/surfaces"],
  "core/marks": ["core/base", "core/geometry", "core/slices"],
  "core/view": ["core/base", "core/geometry", "core/marks", "core/protocol", "core/scan", "core/slices"],
  "core/appearance": ["core/base", "core/geometry", "core/protocol", "core/scan", "core/segments", "core/view"],
  "core/second": ["core/appearance", "core/base", "core/geometry", "core/marks", "core/protocol", "core/scan"],
  "core/tour": ["core/geometry", "core/protocol", "core/view"],
  "core/drawing": [
    ...["core/appearance", "core/base", "core/protocol", "core/second"],
    ...["core/segments", "core/view"],
  ],
  "core/picking": [
    ...["core/appearance", "core/geometry", "core/protocol", "core/scan", "core/second", "core/segments"],
    ...["core/surfaces", "core/view"],
  ],
  "core/touch": [
    ...["core/base", "core/geometry", "core/picking", "core/protocol", "core/scan"],
    ...["core/tissue", "core/tools"],
  ],
  "gl/shaders": [],
  "gl/base": ["core", "gl/shaders"],
  "gl/markers": ["core", "gl/shaders"],
  "gl/textures": ["core", "gl/base"],
  "gl/march": ["core", "gl/base", "gl/shaders", "gl/textures"],
  "gl/surfaces": ["core", "gl/base", "gl/march", "gl/shaders", "gl/textures"],
  "gl/engine_pictures": ["core", "gl/base", "gl/march", "gl/shaders"],
  "gl/picture": ["core", "gl"],
  live: ["core"],
  "ui/state": ["core", "live"],
  "ui/theme": ["ui/state"],
  "ui/widgets": ["core", "ui/state"],
  "ui/features": ["core", "gl", "live", "ui/state", "ui/theme", "ui/widgets"],
  "ui/app": ["core", "gl", "live", "ui/features", "ui/state", "ui/theme", "ui/widgets"],
};

/** Features that import another one, each with its reason. */
const features = {
  "slices -> segments": "the brush and outlines paint a segment in slices",
  "slices -> touch": "the mouse over a slice leads the hand",
  "tools -> segments": "the painter paints with the segment of the brush in slices",
};

/** Forbids `files` to import the named packages. */
function without(files, message, packages) {
  return {
    files,
    rules: {
      "no-restricted-imports": ["error", { patterns: [{ group: packages, message }] }],
    },
  };
}

export default ts.config(
  { ignores: ["node_modules/", "bench/dist/", "src/core/protocol.ts", "src/texts/.wuchale/", "src/texts/data.js"] },
  js.configs.recommended,
  ...ts.configs.strict,
  ...svelte.configs.recommended,
  {
    languageOptions: { globals: { ...globals.browser, ...globals.node } },
    rules: {
      "@typescript-eslint/consistent-type-imports": "error",
      "@typescript-eslint/explicit-module-boundary-types": "error",
      eqeqeq: "error",
      "no-console": "error",
      "max-lines-per-function": ["error", { max: 90, skipComments: true, skipBlankLines: true }],
      // the compiler resolves names better, also in .svelte files
      "no-undef": "off",
    },
  },
  {
    files: ["**/*.svelte", "**/*.svelte.ts"],
    languageOptions: { parserOptions: { parser: ts.parser } },
    rules: {
      // `let { … } = $props()` is Svelte's own form
      "prefer-const": "off",
    },
  },
  {
    // scripts print their result, and the browser is driven by long straight scripts
    files: ["e2e/**", "tests/**", "line_length.js"],
    rules: {
      "no-console": "off",
      "max-lines-per-function": "off",
    },
  },
  {
    // plain JavaScript has no types to write
    files: ["**/*.js", "**/*.mjs", "tests/**"],
    rules: { "@typescript-eslint/explicit-module-boundary-types": "off" },
  },
  {
    files: ["src/**"],
    plugins: { palpate: { rules: { arrows, "arrows-in-order": arrowsInOrder } } },
    rules: { "palpate/arrows": ["error", { rooms, features }] },
  },
  {
    files: ["src/main.ts"],
    rules: { "palpate/arrows-in-order": ["error", { rooms, features }] },
  },
  without(["src/core/**"], "core is pure", ["three", "three/*", "svelte", "svelte/*", "uplot", "@lucide/*"]),
  without(["src/gl/**"], "gl knows no page", ["svelte", "svelte/*", "uplot", "@lucide/*"]),
  without(["src/live/**"], "live knows neither picture nor page", ["three", "three/*", "svelte", "svelte/*"]),
);
