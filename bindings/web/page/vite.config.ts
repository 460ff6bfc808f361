import { defineConfig } from "vite";

// One folder of files that any web server can serve, wherever it lies.
export default defineConfig({ base: "./", build: { outDir: "../dist/page", emptyOutDir: true, target: "es2022" } });
