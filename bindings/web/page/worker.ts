/** Solves away from the page, which stays awake. */
import { Ofc, type Params, type Picture, type Solution } from "../src/index.js";
import wasm from "../dist/ofc.wasm?url";

export interface Question {
  readonly number: number;
  readonly picture: Picture;
  readonly params: Params;
}
export interface Answer {
  readonly number: number;
  readonly solution: Solution | null;
  readonly error: string;
  readonly milliseconds: number;
}

const library = Ofc.load(fetch(wasm));

addEventListener("message", async (event: MessageEvent<Question>) => {
  const { number, picture, params } = event.data;
  try {
    const ofc = await library;
    const began = performance.now();
    const solution = ofc.solve(picture, params);
    postMessage({ number, solution, error: "", milliseconds: performance.now() - began } satisfies Answer);
  } catch (error) {
    postMessage({ number, solution: null, error: String(error), milliseconds: 0 } satisfies Answer);
  }
});
