/** The page in a browser: page.mjs CHROMIUM BALL.png SHOTS. A built-in picture, a dropped one, a key, a phone; screenshots to look at. */
import assert from "node:assert/strict";
import { mkdirSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname } from "node:path";
import { chromium } from "playwright-core";

const [executablePath, ball, shots] = process.argv.slice(2);
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };
const server = createServer((request, response) => {
  try {
    const path = request.url === "/" ? "/index.html" : request.url;
    const body = readFileSync(new URL(`../dist/page${path}`, import.meta.url));
    response.writeHead(200, { "content-type": TYPES[extname(path)] ?? "application/octet-stream" }).end(body);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
mkdirSync(shots, { recursive: true });
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
try {
  const page = await browser.newPage({ viewport: { width: 1200, height: 1150 } });
  const wrong = [];
  page.on("pageerror", (error) => wrong.push(error.message));
  page.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  const solved = async (words) => {
    await page.waitForFunction((text) => document.getElementById("trust").textContent.includes(text), words, { timeout: 120_000 });
    return page.textContent("#trust");
  };
  const colors = (id) =>
    page.$eval(id, (canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return new Set(new Uint32Array(data.buffer)).size;
    });

  console.log("built-in:", await solved("Normals are expected"));
  for (const id of ["#picture", "#normals", "#uncertainty", "#relit"]) assert.ok((await colors(id)) > 50, id);
  await page.screenshot({ path: `${shots}/page.png` });

  // The light follows the keys.
  const before = await page.$eval("#relit", (canvas) => canvas.toDataURL());
  await page.focus("#relit");
  await page.keyboard.press("ArrowRight");
  assert.notEqual(await page.$eval("#relit", (canvas) => canvas.toDataURL()), before);

  // A dropped file is solved; this one is linear.
  const bytes = readFileSync(ball).toString("base64");
  const transfer = await page.evaluateHandle(async (base64) => {
    const blob = await (await fetch(`data:image/png;base64,${base64}`)).blob();
    const dropped = new DataTransfer();
    dropped.items.add(new File([blob], "ball.png", { type: "image/png" }));
    return dropped;
  }, bytes);
  const began = performance.now();
  await page.dispatchEvent("#drop", "drop", { dataTransfer: transfer });
  await solved("ms");
  await page.uncheck("#srgb");
  const said = await solved("Normals are expected");
  console.log(`dropped, ${Math.round(performance.now() - began)} ms for two solves:`, said);
  // The middle of a ball looks at the camera.
  const middle = await page.$eval("#normals", (canvas) => [...canvas.getContext("2d").getImageData(320, 240, 1, 1).data]);
  assert.ok(Math.abs(middle[0] - 128) < 4 && Math.abs(middle[1] - 128) < 4 && middle[2] > 250, String(middle));

  // Every control has a name, and a phone needs no sideways scrolling.
  const unnamed = await page.$$eval("input, select, button, canvas", (all) =>
    all.filter((e) => !(e.getAttribute("aria-label") || e.textContent.trim() || e.labels?.length)).map((e) => e.id),
  );
  assert.deepEqual(unnamed, []);
  await page.setViewportSize({ width: 390, height: 844 });
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  await page.screenshot({ path: `${shots}/phone.png`, fullPage: true });
  assert.deepEqual(wrong, []);
} finally {
  await browser.close();
  server.close();
}
