/** Prints C that compiles for wasm32 only where src/layout.ts agrees with ofc.h. */
import { layout } from "../dist/layout.js";

const lines = ['#include "ofc.h"', "#define AT(type, field, offset) _Static_assert(__builtin_offsetof(type, field) == (offset), #type \".\" #field)"];
for (const [type, { size, ...fields }] of Object.entries(layout)) {
  lines.push(`_Static_assert(sizeof(${type}) == ${size}, "${type}");`);
  for (const [field, offset] of Object.entries(fields)) lines.push(`AT(${type}, ${field}, ${offset});`);
}
console.log(lines.join("\n"));
