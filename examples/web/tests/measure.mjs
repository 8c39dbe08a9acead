// What the page takes, measured in a browser: node examples/web/tests/measure.mjs
//
// First picture, the longest time for which the page itself was busy while a model was built, and what a frame of a terrain of half a million
// triangles takes to adapt and upload while the camera moves.

import { launch, missing, open, serve, settled } from './browser.mjs';

if (missing) {
  console.log(`skipped: ${missing}`);
  process.exit(0);
}
const server = await serve();
const browser = await launch();
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
try {
  const firsts = [];
  for (let i = 0; i < 5; i++) {
    const { page } = await open(browser, `${server.url}?turn=0&geomorph=0`, { width: 1280, height: 720 });
    await settled(page);
    firsts.push(await page.evaluate(() => globalThis.multires.firstPicture));
    if (i === 0) console.log(`drawn by ${await page.evaluate(() => globalThis.multires.card)}`);
    await page.close();
  }
  console.log(`first picture: median ${median(firsts).toFixed(0)} ms of ${firsts.length}`);

  for (const structure of ['hierarchy', 'wavelet']) {
    const { page } = await open(browser, 'about:blank', { width: 1280, height: 720 });
    await page.addInitScript(() => {
      globalThis.longest = 0;
      new PerformanceObserver((list) => {
        for (const task of list.getEntries()) globalThis.longest = Math.max(globalThis.longest, task.duration);
      }).observe({ type: 'longtask', buffered: true });
    });
    const since = Date.now();
    await page.goto(`${server.url}?turn=0&geomorph=0&scene=terrain&structure=${structure}`);
    await settled(page);
    const built = Date.now() - since;
    await page.evaluate(() => { globalThis.multires.frames.length = 0; });
    // Down to the ground, and around.
    await page.hover('#canvas');
    for (let i = 0; i < 40; i++) {
      await page.mouse.wheel(0, -60);
      await page.waitForTimeout(30);
    }
    await page.mouse.down();
    for (let i = 0; i < 120; i++) {
      await page.mouse.move(500 + 2 * i, 360);
      await page.waitForTimeout(20);
    }
    await page.mouse.up();
    const frames = await page.evaluate(() => globalThis.multires.frames);
    const both = frames.map((frame) => (frame.adapt + frame.upload) / 1000);
    const longest = await page.evaluate(() => globalThis.longest);
    console.log(`terrain, ${structure}: ready after ${built} ms; ${frames.length} frames, ${median(frames.map((f) => f.triangles))} triangles, `
      + `adapt and upload median ${median(both).toFixed(2)} ms (adapt ${(median(frames.map((f) => f.adapt)) / 1000).toFixed(2)}), `
      + `longest ${Math.max(...both).toFixed(1)} ms; page busy at most ${longest.toFixed(0)} ms at once (0: never above 50)`);
    await page.close();
  }
} finally {
  await browser.close();
  server.stop();
}
