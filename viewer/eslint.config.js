/**
 * Lints of the viewer, and the arrows between its rooms:
 * core imports nothing; gl and live import core; ui imports all of them.
 */
import js from "@eslint/js";
import svelte from "eslint-plugin-svelte";
import globals from "globals";
import ts from "typescript-eslint";

/** Forbids `files` to import from the named rooms or packages. */
function arrow(files, message, patterns) {
  return {
    files,
    rules: {
      "no-restricted-imports": ["error", { patterns: [{ group: patterns, message }] }],
    },
  };
}

export default ts.config(
  { ignores: ["node_modules/", "bench/dist/", "src/core/protocol.ts"] },
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
    files: ["e2e/**", "tests/**"],
    rules: {
      "no-console": "off",
      "max-lines-per-function": "off",
      // plain JavaScript has no types to write
      "@typescript-eslint/explicit-module-boundary-types": "off",
    },
  },
  arrow(["src/core/**"], "core is pure: it imports only core", [
    "three", "three/*", "svelte", "svelte/*", "uplot", "@lucide/*", "**/gl/*", "**/live/*", "**/ui/*",
  ]),
  arrow(["src/gl/**"], "gl imports core only", ["svelte", "svelte/*", "uplot", "@lucide/*", "**/live/*", "**/ui/*"]),
  arrow(["src/live/**"], "live imports core only", ["three", "three/*", "svelte", "svelte/*", "**/gl/*", "**/ui/*"]),
);
