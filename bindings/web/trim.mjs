/** trim.mjs FROM.wasm TO.wasm NAMES.js: leaves out of the library what the package does not call; what it calls stays as it is. */
import { readFileSync, writeFileSync } from "node:fs";
import binaryen from "binaryen";

const [from, to, source] = process.argv.slice(2);
const called = new Set(["memory", "__heap_base", ...(readFileSync(source, "utf8").match(/"ofc_\w+"/g) ?? []).map((name) => name.slice(1, -1))]);
const module = binaryen.readBinary(readFileSync(from));
const names = Array.from({ length: module.getNumExports() }, (_, i) => binaryen.getExportInfo(module.getExportByIndex(i)).name);
for (const name of called) if (!names.includes(name)) throw new Error(`${from} has no ${name}`);
for (const name of names) if (!called.has(name)) module.removeExport(name);
module.runPasses(["remove-unused-module-elements", "strip-debug", "strip-producers"]);
writeFileSync(to, module.emitBinary());
