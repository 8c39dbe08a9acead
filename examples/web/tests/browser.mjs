// A browser, the page's server, and pictures: what the tests of the page and its measurement share.
//
// Where there is no Chromium or no playwright-core (MULTIRES_PLAYWRIGHT names the folder it was installed to by npm), `missing` says so.

import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

export const root = join(dirname(fileURLToPath(import.meta.url)), '../../..');

const candidates = [process.env.MULTIRES_CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
const chromiumPath = candidates.find((path) => path && existsSync(path));

function playwright() {
  try {
    return createRequire(join(process.env.MULTIRES_PLAYWRIGHT ?? root, 'package.json'))('playwright-core').chromium;
  } catch {
    return undefined;
  }
}
const chromium = playwright();

export const missing = !chromiumPath ? 'no Chromium (Debian: apt-get install chromium)'
  : !chromium ? 'no playwright-core (npm install --prefix DIR playwright-core, MULTIRES_PLAYWRIGHT=DIR)' : undefined;

const flags = [
  '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage',
  '--force-color-profile=srgb',
];
// In software; what one of them needs the other does not start with.
const drawing = {
  webgl: ['--enable-unsafe-swiftshader', '--use-angle=swiftshader'],
  webgpu: [
    '--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=vulkan', '--disable-vulkan-surface',
  ],
};

// A browser that draws by WebGL 2, or by WebGPU.
export const launch = (by = 'webgl') => chromium.launch({ executablePath: chromiumPath, args: [...flags, ...drawing[by]] });

// Starts a server of the page as it was made last, and tells where it listens.
export function serve() {
  const arguments_ = ['run', '--quiet', '-p', 'multires-web-viewer', '--bin', 'serve', '--', '--as-made', '--listen', '127.0.0.1:0'];
  const child = spawn('cargo', arguments_, { cwd: root, stdio: ['ignore', 'pipe', 'inherit'], detached: true });
  const stop = () => { try { process.kill(-child.pid); } catch { /* It is gone already. */ } };
  return new Promise((resolve, reject) => {
    child.on('exit', (code) => reject(new Error(`the server ended: ${code}`)));
    child.stdout.once('data', (line) => resolve({ url: line.toString().trim(), stop }));
  });
}

// Opens a page, and gathers what it complains about.
export async function open(browser, url, { width = 480, height = 300, ...rest } = {}) {
  const page = await browser.newPage({ viewport: { width, height }, ...rest });
  const complaints = [];
  page.on('console', (message) => { if (message.type() === 'error') complaints.push(message.text()); });
  page.on('pageerror', (error) => complaints.push(error.message));
  await page.goto(url);
  return { page, complaints };
}

export const shown = (page) => page.waitForSelector('body[data-state="shown"][data-triangles]', { timeout: 120_000 });

// Waits until nothing moves any more and the last picture is on the screen.
export async function settled(page) {
  await shown(page);
  await page.waitForSelector('body[data-rests="true"]', { timeout: 120_000 });
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

// The picture as PNG, as the page itself takes it: also where a browser without a screen shows no canvas of WebGPU.
export async function picture(page) {
  const base64 = await page.evaluate(async () => {
    const bytes = new Uint8Array(await (await globalThis.multires.snapshot()).arrayBuffer());
    let text = '';
    for (let i = 0; i < bytes.length; i += 4096) text += String.fromCharCode(...bytes.subarray(i, i + 4096));
    return btoa(text);
  });
  return Buffer.from(base64, 'base64');
}

// Mean difference of two PNGs over all pixels and colours, of 255. Decoded by the browser.
export async function difference(page, first, second) {
  return page.evaluate(async (pictures) => {
    const pixels = await Promise.all(pictures.map(async (base64) => {
      const blob = await (await fetch(`data:image/png;base64,${base64}`)).blob();
      const bitmap = await createImageBitmap(blob, { colorSpaceConversion: 'none' });
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      return context.getImageData(0, 0, bitmap.width, bitmap.height);
    }));
    const [a, b] = pixels;
    if (a.width !== b.width || a.height !== b.height) throw new Error(`${a.width} x ${a.height}, ${b.width} x ${b.height}`);
    let sum = 0;
    for (let i = 0; i < a.data.length; i++) if (i % 4 < 3) sum += Math.abs(a.data[i] - b.data[i]);
    return sum / (a.data.length / 4 * 3);
  }, [first, second].map((png) => png.toString('base64')));
}
