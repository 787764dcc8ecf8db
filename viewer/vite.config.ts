/**
 * Builds the page into the Python package, which serves it from the wheel.
 */
import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vitest/config";
import { wuchale } from "wuchale/vite";

// the engine to develop against: `palpate open PATH --port 8000`, then `npm run dev`
const engine = process.env["PALPATE_ENGINE"] ?? "http://127.0.0.1:8000";

export default defineConfig({
  // tests take the texts as the code has them
  plugins: process.env["VITEST"] === undefined ? [wuchale(), svelte()] : [svelte()],
  build: {
    outDir: "../python/palpate/viewer",
    emptyOutDir: true,
    target: "es2022",
    // three alone is larger than the default limit; the page comes from the same machine
    chunkSizeWarningLimit: 1200,
  },
  worker: { format: "es" },
  server: {
    host: "127.0.0.1",
    // looks.json of the Python package
    fs: { allow: [".."] },
    proxy: { "/api": { target: engine, ws: true, changeOrigin: true } },
  },
  test: {
    include: ["tests/**/*.test.ts"],
    globalSetup: "tests/gl/server.ts",
    // a picture on a CPU waits on one core for its programs, so that two files go at once
    maxWorkers: 2,
    // browsers start and pictures are drawn on a CPU that may be busy with something else
    testTimeout: 300_000,
    hookTimeout: 300_000,
  },
});
