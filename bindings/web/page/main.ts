/** The page: a picture comes in, a worker solves it, four canvases show what was found. */
import type { Convexity } from "../src/index.js";
import { drawNormals, drawPicture, drawRelit, drawUncertainty, inWords } from "./draw.js";
import { builtIn, maskOf, pictureOf, pixelsOf } from "./pictures.js";
import type { Answer, Question } from "./worker.js";

function element<T extends HTMLElement>(id: string, kind: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`no ${id}`);
  return found;
}

const canvas = (id: string) => element(id, HTMLCanvasElement);
const trust = element("trust", HTMLElement);
const srgb = element("srgb", HTMLInputElement);
const convexity = element("convexity", HTMLSelectElement);
const drop = element("drop", HTMLElement);
const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });

let pixels: ImageData = builtIn();
let mask: Uint8Array | null = null;
let normals: Float32Array | null = null;
let asked = 0;
const light = { x: -0.6, y: 0.6 };

function say(text: string, refused = false): void {
  trust.textContent = text;
  trust.classList.toggle("refused", refused);
}

function solve(): void {
  drawPicture(canvas("picture"), pixels, null);
  say("Solving…");
  const picture = pictureOf(pixels, srgb.checked, mask);
  // Floats know no largest value; what an 8-bit file clipped is 1.
  const params = { convexity: convexity.value as Convexity, saturation: srgb.checked ? 0.999 : 0 };
  worker.postMessage({ number: ++asked, picture, params } satisfies Question);
}

function relight(): void {
  drawRelit(canvas("relit"), pixels.width, pixels.height, normals, light.x, light.y);
}

worker.addEventListener("message", ({ data }: MessageEvent<Answer>) => {
  if (data.number !== asked) return;
  if (!data.solution) return say(data.error, true);
  normals = data.solution.normals;
  const { width, height } = pixels;
  drawPicture(canvas("picture"), pixels, data.solution);
  drawNormals(canvas("normals"), width, height, normals);
  const median = drawUncertainty(canvas("uncertainty"), width, height, data.solution);
  relight();
  element("scale", HTMLElement).textContent = Number.isNaN(median)
    ? "How sure each normal is: not known"
    : `How sure each normal is: bright is less so, half are within ${median.toFixed(1)} degrees`;
  say(inWords(data.solution, data.milliseconds, median), !normals);
});

async function open(file: Blob | undefined | null): Promise<void> {
  if (!file) return;
  try {
    pixels = await pixelsOf(file);
    mask = null;
    srgb.checked = true;
    solve();
  } catch {
    say("This file is no picture that the browser knows.", true);
  }
}

element("file", HTMLInputElement).addEventListener("change", (event) => void open((event.target as HTMLInputElement).files?.[0]));
element("mask", HTMLInputElement).addEventListener("change", async (event) => {
  const file = (event.target as HTMLInputElement).files?.[0];
  if (!file) return;
  mask = maskOf(await pixelsOf(file, pixels.width, pixels.height));
  solve();
});
element("builtin", HTMLButtonElement).addEventListener("click", () => {
  pixels = builtIn();
  mask = null;
  srgb.checked = false;
  solve();
});
for (const control of [srgb, convexity]) control.addEventListener("change", solve);
addEventListener("dragover", (event) => {
  event.preventDefault();
  drop.classList.add("over");
});
addEventListener("dragleave", () => drop.classList.remove("over"));
addEventListener("drop", (event) => {
  event.preventDefault();
  drop.classList.remove("over");
  void open(event.dataTransfer?.files[0]);
});
canvas("relit").addEventListener("pointermove", (event) => {
  const box = canvas("relit").getBoundingClientRect();
  light.x = (2 * (event.clientX - box.left)) / box.width - 1;
  light.y = 1 - (2 * (event.clientY - box.top)) / box.height;
  relight();
});
canvas("relit").addEventListener("keydown", (event) => {
  const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
  if (!step) return;
  event.preventDefault();
  light.x += step[0] ?? 0;
  light.y += step[1] ?? 0;
  relight();
});

srgb.checked = false;
solve();
