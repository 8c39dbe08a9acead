// How much longer the library takes here than natively, on one thread: node multires-web/tests/measure.mjs [FILE.ply]
//
// The whole sequence of a model's collapses. The file is a binary little-endian PLY whose vertices begin with x, y, z as floats and are nothing
// but floats, and whose faces are triangles; the Stanford bunny of MULTIRES_MODELS where there is none.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { npm, root } from './shapes.mjs';

function readPly(path) {
  const bytes = readFileSync(path);
  const end = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const head = bytes.subarray(0, end).toString('latin1');
  const counted = (what) => Number(head.match(new RegExp(`element ${what} (\\d+)`))[1]);
  const width = head.split('element face')[0].match(/property float/g).length;
  const positions = new Float32Array(3 * counted('vertex'));
  let at = end;
  for (let i = 0; i < positions.length; i += 3, at += 4 * width) {
    for (let k = 0; k < 3; k++) positions[i + k] = bytes.readFloatLE(at + 4 * k);
  }
  const indices = new Uint32Array(3 * counted('face'));
  for (let i = 0; i < indices.length; i += 3, at += 13) {
    if (bytes[at] !== 3) throw new Error('a face is no triangle');
    for (let k = 0; k < 3; k++) indices[i + k] = bytes.readInt32LE(at + 1 + 4 * k);
  }
  return { positions, indices };
}

const file = process.argv[2] ?? join(process.env.MULTIRES_MODELS ?? join(root, '../shared/models'), 'real/stanford-bunny.ply');
const { positions, indices } = readPly(file);
const { default: start, simplify } = await import(pathToFileURL(join(npm, 'index.js')));
await start(readFileSync(join(npm, 'multires_bg.wasm')));

const rounds = 15;
const here = [];
let left;
for (let i = 0; i < rounds; i++) {
  const since = performance.now();
  const simplified = simplify(positions, indices);
  here.push(performance.now() - since);
  left = simplified.indices.length / 3;
  simplified.free();
}
const folder = mkdtempSync(join(tmpdir(), 'multires-measure-'));
try {
  const raw = join(folder, 'mesh');
  writeFileSync(raw, Buffer.concat([Buffer.from(new Uint32Array([positions.length, indices.length]).buffer), Buffer.from(positions.buffer), Buffer.from(indices.buffer)]));
  const native = execFileSync('cargo', ['run', '--quiet', '--release', '-p', 'multires-web', '--example', 'native', '--', raw, String(rounds)], { cwd: root });
  const [milliseconds, triangles] = native.toString().trim().split(' ').map(Number);
  const best = Math.min(...here);
  console.log(`${indices.length / 3} triangles to ${left} (native ${triangles}): ${best.toFixed(1)} ms, native ${milliseconds.toFixed(1)} ms: ${(best / milliseconds).toFixed(2)} times`);
} finally {
  rmSync(folder, { recursive: true, force: true });
}
