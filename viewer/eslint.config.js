/**
 * Lints of the viewer, and the arrows between its rooms: core imports nothing of the others; gl and live import core;
 * ui is app above features above widgets, theme and state.
 */
import js from "@eslint/js";
import svelte from "eslint-plugin-svelte";
import globals from "globals";
import ts from "typescript-eslint";
import { arrows } from "./eslint_arrows.js";

/** What each room of `src/` may import beside itself. */
const rooms = {
  core: [],
  gl: ["core"],
  live: ["core"],
  "ui/state": ["core", "live"],
  "ui/theme": ["core", "ui/state"],
  "ui/widgets": ["core", "ui/state", "ui/theme"],
  "ui/features": ["core", "gl", "live", "ui/state", "ui/theme", "ui/widgets"],
  "ui/app": ["core", "gl", "live", "ui/state", "ui/theme", "ui/widgets", "ui/features"],
};

/** Features that import another one, each with its reason. */
const features = {
  "appearance -> view": "the panel of how the picture looks holds what is cut away, stereo, and how fine it is drawn",
  "slices -> segments": "outlines of a segment are drawn in slices",
  "slices -> touch": "the mouse over a slice leads the hand",
  "tools -> segments": "the painter paints with the segment of the brush in slices",
  "tools -> touch": "the tool is held by the hand",
};

/** To be opened: features that import a file of the app, which is above them. Each should get the one control that it needs. */
const toOpen = {
  "ui/app/stage.svelte": [
    "ui/features/appearance/AppearancePanel.svelte",
    "ui/features/marks/MarkBar.svelte",
    "ui/features/marks/MarkLines.svelte",
    "ui/features/marks/MarksPanel.svelte",
    "ui/features/picking/PickCard.svelte",
    "ui/features/scan/ScanPanel.svelte",
    "ui/features/scan/scene_keeper.svelte.ts",
    "ui/features/second/PairPoints.svelte",
    "ui/features/second/RegistrationPairs.svelte",
    "ui/features/second/RegistrationPanel.svelte",
    "ui/features/segments/CutLine.svelte",
    "ui/features/segments/ObjectHandles.svelte",
    "ui/features/segments/SegmentPlace.svelte",
    "ui/features/segments/SegmentRow.svelte",
    "ui/features/segments/SegmentsPanel.svelte",
    "ui/features/segments/ThresholdEditor.svelte",
    "ui/features/slices/SliceView.svelte",
    "ui/features/slices/SlicesPanel.svelte",
    "ui/features/slices/slice_input.ts",
    "ui/features/touch/FeedbackPanel.svelte",
    "ui/features/touch/gamepad_input.svelte.ts",
    "ui/features/touch/hand_control.svelte.ts",
    "ui/features/view/ClipHandles.svelte",
    "ui/features/view/ClipSettings.svelte",
    "ui/features/view/OrientationCube.svelte",
    "ui/features/view/SaveImage.svelte",
    "ui/features/view/image_control.svelte.ts",
  ],
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
    },
  },
  {
    // plain JavaScript has no types to write
    files: ["**/*.js", "**/*.mjs", "tests/**"],
    rules: { "@typescript-eslint/explicit-module-boundary-types": "off" },
  },
  {
    files: ["src/**"],
    plugins: { palpate: { rules: { arrows } } },
    rules: { "palpate/arrows": ["error", { rooms, features, toOpen }] },
  },
  without(["src/core/**"], "core is pure", ["three", "three/*", "svelte", "svelte/*", "uplot", "@lucide/*"]),
  without(["src/gl/**"], "gl knows no page", ["svelte", "svelte/*", "uplot", "@lucide/*"]),
  without(["src/live/**"], "live knows neither picture nor page", ["three", "three/*", "svelte", "svelte/*"]),
);
