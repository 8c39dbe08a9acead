// What the page takes, measured in a browser, in about a minute: node examples/web/tests/measure.mjs [webgl|webgpu]
//
// First picture; what a frame of a terrain of half a million triangles takes to adapt and upload while the camera moves; the longest time
// for which the page itself was busy at once, from its start to its end, a build among it.

import { launch, missing, open, serve, settled, shown } from './browser.mjs';

if (missing) {
  console.log(`skipped: ${missing}`);
  process.exit(0);
}
const by = process.argv[2] ?? 'webgl';
const server = await serve();
const browser = await launch(by);
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
const still = `turn=0&geomorph=0&backend=${by}`;
try {
  const firsts = [];
  for (let i = 0; i < 5; i++) {
    const { page } = await open(browser, `${server.url}?${still}`, { width: 1280, height: 720 });
    await shown(page);
    firsts.push(await page.evaluate(() => globalThis.multires.firstPicture));
    if (i === 0) console.log(`drawn by ${await page.evaluate(() => globalThis.multires.card)}`);
    await page.close();
  }
  console.log(`first picture: median ${median(firsts).toFixed(0)} ms, slowest ${Math.max(...firsts).toFixed(0)} ms of ${firsts.length}`);

  const { page } = await open(browser, 'about:blank', { width: 900, height: 600 });
  await page.addInitScript(() => {
    globalThis.longest = 0;
    new PerformanceObserver((list) => {
      for (const task of list.getEntries()) globalThis.longest = Math.max(globalThis.longest, task.duration);
    }).observe({ type: 'longtask', buffered: true });
  });
  const since = Date.now();
  await page.goto(`${server.url}?${still}&scene=terrain`);
  await settled(page);
  const built = Date.now() - since;
  await page.evaluate(() => { globalThis.multires.frames.length = 0; });
  // Down to the ground, and around. A step waits for its frame: a software renderer is slower than hands.
  const canvas = await page.locator('#canvas').boundingBox();
  const middle = [canvas.x + canvas.width / 2, canvas.y + canvas.height / 2];
  const drawn = () => page.evaluate(() => new Promise((done) => {
    const before = globalThis.multires.frames.length;
    const look = (tries) => (tries === 0 || globalThis.multires.frames.length > before ? done() : setTimeout(look, 5, tries - 1));
    look(40);
  }));
  await page.mouse.move(...middle);
  for (let i = 0; i < 15; i++) {
    await page.mouse.wheel(0, -150);
    await drawn();
  }
  await page.mouse.down();
  for (let i = 0; i < 35; i++) {
    await page.mouse.move(middle[0] + 3 * i - 50, middle[1]);
    await drawn();
  }
  await page.mouse.up();
  const frames = await page.evaluate(() => globalThis.multires.frames);
  const of = (value) => median(frames.map(value)).toFixed(2);
  console.log(`terrain: ready after ${built} ms; ${frames.length} frames of ${of((f) => f.triangles)} triangles: adapt and upload median `
    + `${of((f) => (f.adapt + f.upload) / 1000)} ms (adapt ${of((f) => f.adapt / 1000)}, upload ${of((f) => f.upload / 1000)})`);
  const longest = await page.evaluate(() => globalThis.longest);
  console.log(`page busy at most ${longest.toFixed(0)} ms at once (0: never above 50)`);
} finally {
  await browser.close();
  server.stop();
}
