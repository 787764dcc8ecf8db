/**
 * Builds what `palpate bench render` puts into the page beside Palpate's own picture: vtk.js, as one script. It stays
 * in this folder and is shipped with nothing.
 */
import { defineConfig } from "vite";

export default defineConfig({
  root: import.meta.dirname,
  publicDir: false,
  build: {
    outDir: "dist",
    emptyOutDir: true,
    target: "es2022",
    chunkSizeWarningLimit: 4000,
    lib: { entry: "vtk_page.ts", formats: ["iife"], name: "vtkPage", fileName: () => "vtk.js" },
  },
});
