/**
 * Orientation from color: surface normals, how sure they are, and depth from one RGB picture of a matte surface of one color under
 * unknown colored lights. The C library as it is, in WebAssembly: the same bits as everywhere.
 */
import { layout } from "./layout.js";

/** A picture of linear values. */
export interface Picture {
  /** Interleaved samples, row 0 at the top: three or four channels a pixel, red first; a fourth one is ignored. */
  readonly data: Uint8Array | Uint8ClampedArray | Uint16Array | Float32Array;
  readonly width: number;
  readonly height: number;
  /** A byte for each pixel, zero where it is left out. */
  readonly mask?: Uint8Array | undefined;
}

export type Convexity = "auto" | "convex" | "hollow";

export interface Params {
  /** The level from which a channel is saturated; 0 for the largest value of the type, and for none with floats. */
  readonly saturation?: number;
  readonly seed?: bigint;
  readonly convexity?: Convexity;
}

/** What a refusal or a doubt comes from. */
export interface Reason {
  readonly message: string;
  readonly advice: string;
}

/** What was found; a picture that does not determine its normals has a status above zero, a reason, and no normals. */
export interface Solution {
  readonly status: number;
  readonly message: string;
  readonly reason: Reason | null;
  /** 255 for each pixel that obeys the model. */
  readonly inliers: Uint8Array;
  readonly inlierCount: number;
  /** How many pixels the mask leaves. */
  readonly pixelCount: number;
  /** F, row by row: the one light that each channel could have been lit by; zeros without an answer. */
  readonly f: Float64Array;
  /** The angle in radians by which all normals may be turned together; NaN where it is not known. */
  readonly error: number;
  /** How clearly the surface is convex, from 0 to 1. */
  readonly convexity: number;
  /** x right, y up, z toward the camera for each pixel; zero where there is none. Null without an answer. */
  readonly normals: Float32Array | null;
  /** The 1-sigma angle of each normal in radians, pi where there is none. Null where it is not known. */
  readonly uncertainty: Float32Array | null;
}

/** A call could not take its arguments. */
export class OfcError extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
    this.name = "OfcError";
  }
}

type Call = (...values: (number | bigint)[]) => number;

const PIXEL_RGB8 = 1;
const FOUR_CHANNELS = 2;
const PIXEL_COUNTS_STATUSES = [-40, -41, -42];
const CONVEXITY: Record<Convexity, number> = { auto: 0, convex: 1, hollow: 2 };

/** The library in its own memory. One call at a time: give each worker one. */
export class Ofc {
  private readonly memory: WebAssembly.Memory;
  private readonly calls: Record<string, Call>;
  private readonly base: number;
  private next = 0;

  private constructor(exports: WebAssembly.Exports) {
    this.memory = exports["memory"] as WebAssembly.Memory;
    this.base = (exports["__heap_base"] as WebAssembly.Global).value as number;
    this.calls = exports as unknown as Record<string, Call>;
  }

  /** Makes it of ofc.wasm: bytes, a compiled module, or what fetch() promises. */
  static async load(source: BufferSource | WebAssembly.Module | Response | Promise<Response>): Promise<Ofc> {
    const given = await source;
    const bytes = given instanceof Response ? await given.arrayBuffer() : given;
    const module = bytes instanceof WebAssembly.Module ? bytes : await WebAssembly.compile(bytes);
    return new Ofc((await WebAssembly.instantiate(module)).exports);
  }

  /** The version of the library. */
  get version(): string {
    return this.text(this.call("ofc_version_string"));
  }

  /**
   * Finds the lights of a picture and the normals under them.
   * @throws OfcError for arguments that the library cannot take, such as a mask of another size.
   */
  solve(picture: Picture, params: Params = {}): Solution {
    this.next = this.base;
    const { width, height } = picture;
    const image = this.image(picture);
    const given = this.take(layout.ofc_solve_params.size);
    this.ensure(this.call("ofc_solve_params_default", given));
    this.view().setFloat64(given + layout.ofc_solve_params["lmeds.saturation"], params.saturation ?? 0, true);
    this.view().setBigUint64(given + layout.ofc_solve_params["lmeds.seed"], params.seed ?? 0n, true);
    this.view().setInt32(given + layout.ofc_solve_params.convexity, CONVEXITY[params.convexity ?? "auto"], true);
    const bytes = this.call("ofc_solve_workspace_size", width, height, given);
    const workspace = this.take(bytes);
    const inliers = this.take(width * height);
    const solution = this.take(layout.ofc_solution.size);
    const status = this.call("ofc_solve", image, given, workspace, bytes, inliers, solution);
    if (PIXEL_COUNTS_STATUSES.includes(status)) return this.refusal(status, image, given, workspace, bytes, picture);
    this.ensure(Math.min(status, 0));

    const at = layout.ofc_solution;
    const view = this.view();
    const found = {
      status,
      message: this.text(this.call("ofc_status_message", status)),
      reason: this.reason(view.getInt32(solution + at.reason, true)),
      inliers: this.bytes(inliers, width * height),
      inlierCount: view.getInt32(solution + at.inlier_count, true),
      pixelCount: width * height - view.getInt32(solution + at["pixel_counts.masked_out"], true),
      f: Float64Array.from({ length: 9 }, (_, i) => view.getFloat64(solution + at["orientation.f"] + 8 * i, true)),
      error: view.getFloat64(solution + at["confidence.error_rad"], true),
      convexity: view.getFloat64(solution + at["confidence.convexity"], true),
    };
    if (status !== 0) return { ...found, normals: null, uncertainty: null };
    const map = this.take(12 * width * height);
    this.ensure(this.call("ofc_normals_compute", image, solution, map, 12 * width));
    const normals = this.floats(map, 3 * width * height);
    const known = this.call("ofc_normals_uncertainty", image, solution, map, 4 * width) === 0;
    return { ...found, normals, uncertainty: known ? this.floats(map, width * height) : null };
  }

  /** Integrates normals, over a mask where there is one, into depth in the unit of the pixel pitch; NaN where there is none. */
  integrate(normals: Float32Array, width: number, height: number, mask?: Uint8Array, pixelPitch = 1): Float32Array {
    this.next = this.base;
    ensureLength(normals, 3 * width * height, "normals");
    const at = layout.ofc_depth_input;
    const input = this.zeros(at.size);
    const map = this.put(normals);
    const where = mask ? this.put(mask) : 0;
    if (mask) ensureLength(mask, width * height, "mask");
    for (const [offset, value] of [
      [at.normals, map],
      [at.normals_stride_bytes, 12 * width],
      [at.mask, where],
      [at.mask_stride_bytes, width],
      [at.width, width],
      [at.height, height],
    ] as const)
      this.view().setUint32(input + offset, value, true);
    const params = this.take(layout.ofc_depth_params.size);
    this.ensure(this.call("ofc_depth_params_default", params));
    this.view().setFloat64(params + layout.ofc_depth_params.pixel_pitch, pixelPitch, true);
    const bytes = this.call("ofc_depth_workspace_size", width, height);
    const workspace = this.take(bytes);
    const depth = this.take(4 * width * height);
    const result = this.take(layout.ofc_depth_result.size);
    const status = this.call("ofc_depth_integrate", input, params, workspace, bytes, depth, 4 * width, result);
    this.ensure(Math.min(status, 0));
    return this.floats(depth, width * height);
  }

  private refusal(status: number, image: number, params: number, memory: number, bytes: number, picture: Picture): Solution {
    const counts = this.take(layout.ofc_pixel_counts.size);
    const reason = this.take(4);
    this.ensure(this.call("ofc_pixel_counts_compute", image, params, memory, bytes, counts, reason));
    return {
      status,
      message: this.text(this.call("ofc_status_message", status)),
      reason: this.reason(this.view().getInt32(reason, true)),
      inliers: new Uint8Array(picture.width * picture.height),
      inlierCount: 0,
      pixelCount: picture.width * picture.height - this.view().getInt32(counts + layout.ofc_pixel_counts.masked_out, true),
      f: new Float64Array(9),
      error: NaN,
      convexity: NaN,
      normals: null,
      uncertainty: null,
    };
  }

  private reason(number: number): Reason | null {
    if (number === 0) return null;
    return {
      message: this.text(this.call("ofc_reason_message", number)),
      advice: this.text(this.call("ofc_reason_advice", number)),
    };
  }

  private image(picture: Picture): number {
    const { data, width, height, mask } = picture;
    const channels = data.length / (width * height);
    if (channels !== 3 && channels !== 4) throw new RangeError(`${data.length} samples are not ${width} x ${height} pixels`);
    if (mask) ensureLength(mask, width * height, "mask");
    const kind = data instanceof Float32Array ? 20 : data instanceof Uint16Array ? 10 : 0;
    const at = layout.ofc_image;
    const image = this.zeros(at.size);
    const pixels = this.put(data);
    const where = mask ? this.put(mask) : 0;
    for (const [offset, value] of [
      [at.pixels, pixels],
      [at.width, width],
      [at.height, height],
      [at.row_stride_bytes, channels * width * data.BYTES_PER_ELEMENT],
      [at.format, PIXEL_RGB8 + kind + (channels === 4 ? FOUR_CHANNELS : 0)],
      [at.mask, where],
      [at.mask_stride_bytes, width],
    ] as const)
      this.view().setUint32(image + offset, value, true);
    return image;
  }

  /** Memory for a struct whose other fields are zero. */
  private zeros(bytes: number): number {
    const address = this.take(bytes);
    new Uint8Array(this.memory.buffer, address, bytes).fill(0);
    return address;
  }

  /** Memory for this call, zero or not. */
  private take(bytes: number): number {
    const address = Math.ceil(this.next / 16) * 16;
    this.next = address + bytes;
    const lacking = this.next - this.memory.buffer.byteLength;
    if (lacking > 0) this.memory.grow(Math.ceil(lacking / 65536));
    return address;
  }

  private put(array: Uint8Array | Uint8ClampedArray | Uint16Array | Float32Array): number {
    const address = this.take(array.byteLength);
    new Uint8Array(this.memory.buffer).set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), address);
    return address;
  }

  private call(name: string, ...values: (number | bigint)[]): number {
    const call = this.calls[name];
    if (!call) throw new Error(`this is not ofc.wasm: it has no ${name}`);
    return call(...values);
  }

  private ensure(status: number): void {
    if (status !== 0) throw new OfcError(status, this.text(this.call("ofc_status_message", status)));
  }

  private text(address: number): string {
    const bytes = new Uint8Array(this.memory.buffer);
    return new TextDecoder().decode(bytes.slice(address, bytes.indexOf(0, address)));
  }

  private view(): DataView {
    return new DataView(this.memory.buffer);
  }

  private bytes(address: number, length: number): Uint8Array {
    return new Uint8Array(this.memory.buffer, address, length).slice();
  }

  private floats(address: number, length: number): Float32Array {
    return new Float32Array(this.memory.buffer, address, length).slice();
  }
}

function ensureLength(array: Uint8Array | Float32Array, length: number, name: string): void {
  if (array.length !== length) throw new RangeError(`${name}: ${length} values, not ${array.length}`);
}
