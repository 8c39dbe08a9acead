// The page in a real browser.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';

import { difference, launch, missing, open, picture, root, serve, settled, shown } from './browser.mjs';

const folder = mkdtempSync(join(tmpdir(), 'multires-page-'));
let browser;
let server;

// The native viewer's picture of the same view.
function native(name, ...more) {
  const out = join(folder, name);
  const size = ['--headless', '--size', '480x300', '--fov', '45', '--out', out];
  const [program, leading] = process.env.MULTIRES_VIEWER
    ? [resolve(process.env.MULTIRES_VIEWER), []]
    : ['cargo', ['run', '--quiet', '-p', 'multires-viewer', '--']];
  const told = execFileSync(program, [...leading, ...size, ...more], { cwd: root });
  const triangles = Number(told.toString().match(/frame +0: (\d+) triangles/)[1]);
  return Object.assign(readFileSync(join(out, 'frame-0000.png')), { triangles });
}

// Drops a file on the page as a hand would.
async function drop(page, name, bytes) {
  const transfer = await page.evaluateHandle(([name, bytes]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([new Uint8Array(bytes)], name));
    return transfer;
  }, [name, [...bytes]]);
  await page.dispatchEvent('#view', 'drop', { dataTransfer: transfer });
}

describe('the page', { skip: missing && `skipped: ${missing}` }, () => {
  before(async () => {
    server = await serve();
    browser = await launch();
  });
  after(async () => {
    await browser?.close();
    server?.stop();
    rmSync(folder, { recursive: true, force: true });
  });

  const still = 'turn=0&geomorph=0&dark=0&shading=material';

  test('triangles change when the camera moves', async () => {
    const { page, complaints } = await open(browser, `${server.url}?${still}`, { width: 900, height: 600 });
    await settled(page);
    const before = Number(await page.getAttribute('body', 'data-triangles'));
    assert.ok(before > 100, `${before}`);
    await page.hover('#canvas');
    for (let i = 0; i < 8; i++) await page.mouse.wheel(0, -300);
    await page.waitForFunction((before) => Number(document.body.dataset.triangles) !== before, before);
    await settled(page);
    const near = Number(await page.getAttribute('body', 'data-triangles'));
    assert.notEqual(near, before);
    await page.keyboard.press('0');
    await page.focus('#canvas');
    await page.keyboard.press('0');
    await page.waitForFunction((before) => Number(document.body.dataset.triangles) === before, before);
    assert.deepEqual(complaints, []);
    await page.close();
  });

  for (const backend of ['webgl', 'webgpu']) {
    test(`pictures are the native viewer's, by ${backend}`, async (t) => {
      const browser = await launch(backend);
      t.after(() => browser.close());
      const { page, complaints } = await open(browser, `${server.url}?${still}&panel=0&backend=${backend}`);
      await Promise.race([settled(page), page.waitForSelector('body[data-state="failed"]')]);
      if (backend === 'webgpu' && await page.getAttribute('body', 'data-state') === 'failed') {
        const reason = await page.textContent('#alert-text');
        assert.match(reason, /adapter/);
        await page.close();
        return t.skip(`skipped: this browser has no WebGPU (${reason})`);
      }
      const plain = await picture(page);
      if (backend === 'webgl') assert.ok(await difference(page, plain, await page.screenshot({ type: 'png' })) < 0.5, 'what is taken is what is seen');
      const off = await difference(page, plain, native('plain', '--scene', 'demo'));
      assert.ok(off < 2, `plain: ${off}`);
      // A picture of nothing would be nearly as far off as a wrong one: the model is there.
      const { page: empty } = await open(browser, 'about:blank');
      assert.ok(await difference(empty, plain, await empty.screenshot({ type: 'png' })) > 10);
      await empty.close();

      await page.goto(`${server.url}?${still.replace('material', 'level')}&panel=0&wire=1&backend=${backend}`);
      await settled(page);
      const wire = await picture(page);
      const lines = await difference(page, wire, native('wire', '--scene', 'demo', '--wire', '--shading', 'level'));
      assert.ok(lines < 2, `wire: ${lines}`);
      const without = await difference(page, wire, native('level', '--scene', 'demo', '--shading', 'level'));
      assert.ok(without > 2 * lines, `edges are drawn: ${without}, ${lines}`);
      t.diagnostic(`mean difference of 255: ${off.toFixed(3)}, with edges ${lines.toFixed(3)}`);
      assert.deepEqual(complaints, []);
      await page.close();
    });
  }

  test('a thousand g-meshes are drawn', async () => {
    const { page, complaints } = await open(browser, `${server.url}?${still}&scene=crowd&panel=0`);
    await settled(page);
    const expected = native('crowd', '--scene', 'crowd', '--structure', 'gmesh');
    assert.equal(Number(await page.getAttribute('body', 'data-triangles')), expected.triangles);
    // Rocks of a few pixels, whose samples lie elsewhere with another driver.
    const off = await difference(page, await picture(page), expected);
    assert.ok(off < 4, `${off}`);
    assert.deepEqual(complaints, []);
    await page.close();
  });

  test('a frozen cut stays', async () => {
    const { page } = await open(browser, `${server.url}?${still}`, { width: 900, height: 600 });
    await settled(page);
    await page.check('#freeze');
    await settled(page);
    const before = await page.getAttribute('body', 'data-triangles');
    const frames = await page.evaluate(() => globalThis.multires.frames.length);
    await page.hover('#canvas');
    await page.mouse.wheel(0, -600);
    await page.waitForFunction((frames) => globalThis.multires.frames.length > frames, frames);
    await settled(page);
    assert.equal(await page.getAttribute('body', 'data-triangles'), before);
    await page.uncheck('#freeze');
    await page.waitForFunction((before) => document.body.dataset.triangles !== before, before);
    await page.close();
  });

  test('a budget is kept', async () => {
    const { page } = await open(browser, `${server.url}?${still}&scene=rocks`, { width: 900, height: 600 });
    await settled(page);
    assert.ok(Number(await page.getAttribute('body', 'data-triangles')) > 10_000);
    await page.fill('#budget', '4');
    await page.waitForFunction(() => Number(document.body.dataset.triangles) <= 10_000);
    await page.close();
  });

  test('a dropped file is shown, a bad one is a message', async () => {
    const { page, complaints } = await open(browser, `${server.url}?${still}`, { width: 900, height: 600 });
    await settled(page);
    await drop(page, 'broken.ply', Buffer.from('ply\nformat ascii 1.0\nelement vertex many\n'));
    await page.waitForSelector('body[data-state="failed"]');
    assert.match(await page.textContent('#alert-text'), /broken\.ply/);
    await drop(page, 'notes.txt', Buffer.from('not a mesh'));
    await page.waitForFunction(() => document.getElementById('alert-text').textContent.includes('notes.txt'));
    const tetrahedron = 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n';
    await drop(page, 'tetrahedron.obj', Buffer.from(tetrahedron));
    await page.waitForFunction(() => document.getElementById('full').textContent === '4');
    await settled(page);
    assert.ok(await page.isHidden('#alert'));
    assert.deepEqual(complaints, []);
    await page.close();
  });

  test('all structures are built', async () => {
    const { page, complaints } = await open(browser, `${server.url}?${still}&scene=rocks`, { width: 900, height: 600 });
    await settled(page);
    for (const structure of ['tom', 'gmesh', 'wavelet', 'hierarchy']) {
      await page.selectOption('#structure', structure);
      await page.waitForSelector('body[data-state="loading"]', { timeout: 5_000 }).catch(() => {});
      await settled(page);
      assert.ok(Number(await page.getAttribute('body', 'data-triangles')) > 0, structure);
    }
    assert.deepEqual(complaints, []);
    await page.close();
  });

  test('a phone has room for it', async () => {
    const { page } = await open(browser, `${server.url}?${still}`, { width: 360, height: 740, hasTouch: true, isMobile: true });
    await shown(page);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
    const box = await page.locator('#view').boundingBox();
    assert.ok(box.height > 340, `${box.height}`);
    await page.close();
  });
});
