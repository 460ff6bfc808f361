/** Pictures as the library takes them: linear, and no larger than it takes to see something at once. */
import type { Picture } from "../src/index.js";

const LARGEST = 1024;
/** Below this a pixel of an 8-bit picture is what compression leaves of black. */
const BLACK = 6;

const linear = Float32Array.from({ length: 256 }, (_, i) => {
  const value = i / 255;
  return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
});

/** The pixels of a file, red, green, blue and opacity, from 0 to 255. */
export async function pixelsOf(file: Blob, width?: number, height?: number): Promise<ImageData> {
  const bitmap = await createImageBitmap(file, { colorSpaceConversion: "none" });
  const scale = Math.min(1, LARGEST / Math.max(bitmap.width, bitmap.height));
  const canvas = new OffscreenCanvas(width ?? Math.round(bitmap.width * scale), height ?? Math.round(bitmap.height * scale));
  const context = canvas.getContext("2d");
  if (!context) throw new Error("the browser has no canvas");
  context.drawImage(bitmap, 0, 0, canvas.width, canvas.height);
  return context.getImageData(0, 0, canvas.width, canvas.height);
}

/** The picture that the library gets: without the curve of sRGB, or as it is. */
export function pictureOf(pixels: ImageData, undo: boolean, mask: Uint8Array | null): Picture {
  const { width, height } = pixels;
  const where = mask ?? notBlack(pixels);
  if (!undo) return { data: pixels.data, width, height, mask: where };
  const data = Float32Array.from(pixels.data, (value) => linear[value] ?? 0);
  return { data, width, height, mask: where };
}

/** A pixel for each pixel of a mask that is bright. */
export function maskOf(pixels: ImageData): Uint8Array {
  return Uint8Array.from({ length: pixels.width * pixels.height }, (_, i) => ((pixels.data[4 * i] ?? 0) > 127 ? 255 : 0));
}

function notBlack({ data, width, height }: ImageData): Uint8Array {
  const bright = (i: number) => Math.max(data[4 * i] ?? 0, data[4 * i + 1] ?? 0, data[4 * i + 2] ?? 0) > BLACK;
  return Uint8Array.from({ length: width * height }, (_, i) => (bright(i) ? 255 : 0));
}

/** A rippled dome under three lamps, 640 x 480, linear, with noise that is always the same. */
export function builtIn(): ImageData {
  const [width, height] = [640, 480];
  const pixels = new ImageData(width, height);
  const rows = [
    [85, 12, 120],
    [-50, 70, 125],
    [-30, -75, 118],
  ] as const;
  const depth = (u: number, v: number) =>
    0.8 * Math.sqrt(Math.max(0, 1 - u * u - v * v)) + 0.035 * Math.cos(9 * u) * Math.cos(8 * v);
  const step = 1e-3;
  let state = 1;
  const noise = () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 31 - 1;
  };
  for (let y = 0; y < height; y++)
    for (let x = 0; x < width; x++) {
      const [u, v] = [(x - 319.5) / 240, (239.5 - y) / 240];
      const square = u * u + v * v;
      const at = 4 * (y * width + x);
      pixels.data[at + 3] = 255;
      if (square >= 0.9) continue;
      const p = (depth(u + step, v) - depth(u - step, v)) / (2 * step);
      const q = (depth(u, v + step) - depth(u, v - step)) / (2 * step);
      const length = Math.hypot(p, q, 1);
      rows.forEach(([a, b, c], channel) => {
        pixels.data[at + channel] = Math.max(0, Math.round((-a * p - b * q + c) / length + noise()));
      });
    }
  return pixels;
}
