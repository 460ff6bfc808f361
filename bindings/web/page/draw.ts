/** What is shown of a solution. */
import type { Solution } from "../src/index.js";

function paint(canvas: HTMLCanvasElement, width: number, height: number, color: (pixel: number) => readonly [number, number, number]): void {
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d");
  if (!context) return;
  const image = context.createImageData(width, height);
  for (let i = 0; i < width * height; i++) {
    const [r, g, b] = color(i);
    image.data.set([r, g, b, 255], 4 * i);
  }
  context.putImageData(image, 0, 0);
}

/** The picture as it came, its outliers dimmed. */
export function drawPicture(canvas: HTMLCanvasElement, pixels: ImageData, solution: Solution | null): void {
  const dim = (i: number) => (!solution?.normals || solution.inliers[i] ? 1 : 0.35);
  const sample = (i: number, c: number) => (pixels.data[4 * i + c] ?? 0) * dim(i);
  paint(canvas, pixels.width, pixels.height, (i) => [sample(i, 0), sample(i, 1), sample(i, 2)]);
}

/** 255 (n + 1) / 2, and black where there is none. */
export function drawNormals(canvas: HTMLCanvasElement, width: number, height: number, normals: Float32Array | null): void {
  const component = (i: number, c: number) => Math.round((255 * ((normals?.[3 * i + c] ?? 0) + 1)) / 2);
  const known = (i: number) => (normals?.[3 * i + 2] ?? 0) !== 0;
  paint(canvas, width, height, (i) => (known(i) ? [component(i, 0), component(i, 1), component(i, 2)] : [0, 0, 0]));
}

/** From dark violet, where normals are surest, to yellow; the median in degrees. */
export function drawUncertainty(canvas: HTMLCanvasElement, width: number, height: number, solution: Solution): number {
  const { uncertainty, inliers } = solution;
  const known = uncertainty ? uncertainty.filter((_, i) => inliers[i]).sort() : new Float32Array();
  const quantile = (share: number) => known[Math.floor(share * (known.length - 1))] ?? NaN;
  const [low, high] = [quantile(0.01), quantile(0.99)];
  paint(canvas, width, height, (i) => {
    if (!uncertainty || !inliers[i]) return [0, 0, 0];
    const t = Math.min(1, Math.max(0, ((uncertainty[i] ?? 0) - low) / (high - low || 1)));
    return [68 + 185 * t ** 1.5, 1 + 230 * t, 84 + 90 * Math.sin(Math.PI * t) - 50 * t];
  });
  return (quantile(0.5) * 180) / Math.PI;
}

/** The surface under one white light: x and y of its direction from -1 to 1. */
export function drawRelit(canvas: HTMLCanvasElement, width: number, height: number, normals: Float32Array | null, x: number, y: number): void {
  const length = Math.hypot(x, y, 0.7);
  const [a, b, c] = [x / length, y / length, 0.7 / length];
  const n = (i: number, k: number) => normals?.[3 * i + k] ?? 0;
  paint(canvas, width, height, (i) => {
    const shade = 255 * Math.max(0, a * n(i, 0) + b * n(i, 1) + c * n(i, 2)) ** (1 / 2.2);
    return [shade, shade, shade];
  });
}

/** How far to trust it, in a sentence. */
export function inWords(solution: Solution, milliseconds: number, median: number): string {
  const why = solution.reason ? `${solution.reason.message}. Try: ${solution.reason.advice}` : "";
  if (!solution.normals) return `Refused: ${why || solution.message}.`;
  const sure = Number.isNaN(median)
    ? "How far the normals are off is not known"
    : `Normals are expected to be off by ${median.toFixed(1)} degrees, as a whole by ${((solution.error * 180) / Math.PI).toFixed(1)}`;
  const shape = solution.convexity > 0.5 ? "clearly convex" : "convex or hollow is not clear";
  const share = Math.round((100 * solution.inlierCount) / Math.max(1, solution.pixelCount));
  return `${sure}; ${shape}; ${share} % of the pixels obey the model; ${Math.round(milliseconds)} ms.${why ? ` Doubt: ${why}.` : ""}`;
}
