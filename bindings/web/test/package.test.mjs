/** The package against the native library: the same bits, refusals with reasons, and depth. */
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { Ofc, OfcError } from "../dist/index.js";

const ofc = await Ofc.load(readFileSync(new URL("../dist/ofc.wasm", import.meta.url)));
const [width, height] = [640, 480];
const ball = { data: new Uint8Array(readFileSync(process.env.OFC_BALL)), width, height };

test("normals have the native library's bits", () => {
  const solution = ofc.solve(ball);
  assert.equal(solution.status, 0);
  const digest = createHash("sha256").update(new Uint8Array(solution.normals.buffer)).digest("hex");
  assert.equal(digest, process.env.OFC_NORMALS_SHA256);
});

test("a mask, four channels and floats are the same picture", () => {
  const mask = new Uint8Array(width * height).fill(1);
  const four = Uint8ClampedArray.from({ length: 4 * width * height }, (_, i) => (i % 4 < 3 ? ball.data[3 * (i >> 2) + (i % 4)] : 255));
  const expected = ofc.solve(ball);
  assert.deepEqual(ofc.solve({ ...ball, mask }).normals, expected.normals);
  assert.deepEqual(ofc.solve({ data: four, width, height }).normals, expected.normals);
  assert.ok(ofc.solve({ data: Float32Array.from(ball.data), width, height }).inlierCount > 0.9 * expected.inlierCount);
});

test("depth rises to the middle, and the answer says how sure it is", () => {
  const { normals, inliers, uncertainty, error, convexity } = ofc.solve(ball);
  const depth = ofc.integrate(normals, width, height, inliers);
  const at = (x, y) => depth[y * width + x];
  assert.ok(at(320, 240) > at(320, 140) && at(320, 240) > at(220, 240));
  assert.ok(error >= 0 && convexity > 0.5 && uncertainty.some((angle) => angle < 0.1));
});

test("a refusal has a reason and an advice", () => {
  const flat = ofc.solve({ data: new Uint8Array(3 * 64 * 64).fill(90), width: 64, height: 64 });
  assert.ok(flat.status > 0 && flat.normals === null);
  assert.match(flat.reason.message, /flat/);
  assert.match(flat.reason.advice, /bends/);
  const black = ofc.solve({ data: new Uint8Array(3 * 64 * 64), width: 64, height: 64 });
  assert.ok(black.status < 0);
  assert.match(black.reason.message, /black|dark/);
});

test("what is no picture throws", () => {
  assert.throws(() => ofc.solve({ ...ball, width: 641 }), RangeError);
  assert.throws(() => ofc.solve({ ...ball, mask: new Uint8Array(5) }), RangeError);
  assert.throws(() => ofc.solve({ data: new Uint8Array(0), width: 0, height: 0 }));
  assert.throws(() => ofc.solve(ball, { saturation: NaN }), OfcError);
  assert.equal(ofc.version, process.env.OFC_VERSION);
});
