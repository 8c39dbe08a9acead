// The npm package as its users have it, in Node.js: made by `cargo run -p multires-web-viewer --bin pack`.

import assert from 'node:assert/strict';
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { before, describe, test } from 'node:test';
import { pathToFileURL } from 'node:url';

import { lookAt, npm, rock } from './shapes.mjs';

const made = existsSync(join(npm, 'multires_bg.wasm'));

describe('multires-web', { skip: !made && 'skipped: not made (cargo run -p multires-web-viewer --bin pack)' }, () => {
  let library;
  before(async () => {
    library = await import(pathToFileURL(join(npm, 'index.js')));
    await library.default(readFileSync(join(npm, 'multires_bg.wasm')));
  });

  test('a mesh is simplified over the same vertices', () => {
    const { positions, normals, uvs, indices } = rock(80);
    const simplified = library.simplify(positions, indices, { normals, uvs, ratio: 0.1 });
    const left = simplified.indices;
    assert.ok(left.length <= indices.length / 10 && left.length > 0);
    assert.equal(simplified.triangles.length * 3, left.length);
    assert.ok(left.every((index) => index < positions.length / 3));
    assert.equal(simplified.reason, 'target');
    assert.ok(simplified.error > 0 && simplified.error < 0.2, `${simplified.error}`);
    const again = library.simplify(positions, indices, { normals, uvs, ratio: 0.1 });
    assert.deepEqual(again.indices, left);
    const far = library.simplify(positions, indices, { error: 0.01 });
    assert.ok(far.error <= 0.01 && far.indices.length < indices.length);
  });

  test('what is wrong is said', () => {
    const { positions, indices } = rock(8);
    const fails = (message, ...given) => assert.throws(() => library.simplify(...given), { message });
    fails(/multiple of 3/, positions.subarray(1), indices);
    fails(/multiple of 3/, positions, indices.subarray(1));
    fails(/out of range|vertices/, positions.subarray(0, 9), indices);
    fails(/finite/, positions.map((x, i) => i === 7 ? NaN : x), indices);
    fails(/ratio is not a number/, positions, indices, { ratio: 'half' });
    fails(/Float32Array/, positions, indices, { normals: [0, 1, 0] });
    fails(/normal/, positions, indices, { normals: new Float32Array(3) });
    fails(/-1/, positions, indices, { triangles: -1 });
    assert.throws(() => new library.Lod(positions, indices, { structure: 'tree' }), { message: /tree/ });
    const lod = new library.Lod(positions, indices);
    assert.throws(() => lod.addView(new Float32Array(15), 1, 100, 100, 1), { message: /16/ });
    assert.throws(() => lod.addView(new Float32Array(16).fill(NaN), 1, 100, 100, 1));
  });

  for (const structure of ['hierarchy', 'tom']) {
    test(`a ${structure} follows a camera, and changes are told`, () => {
      const { positions, normals, uvs, indices } = rock(120);
      const lod = new library.Lod(positions, indices, { normals, uvs, structure });
      const arranged = lod.arrange(positions, 3);
      lod.order.forEach((from, to) => assert.equal(arranged[3 * to], positions[3 * from]));
      assert.equal(lod.fullTriangles, indices.length / 3);
      // A copy that is kept in step by what is told to have changed alone.
      const copy = new Uint32Array(indices.length);
      let counts = [];
      for (const distance of [40, 10, 3, 1.3, 1.3, 5]) {
        lod.addView(lookAt([0, 0, distance]), 0.8, 1280, 720, 1);
        const differs = lod.adapt(1 / 60);
        const [changed, triangles] = [lod.changed(0), lod.triangles];
        const drawn = lod.indices();
        assert.equal(drawn.length, 3 * triangles);
        assert.ok(differs || changed.length === 0);
        for (let i = 0; i < changed.length; i += 2) {
          const [start, count] = [changed[i], changed[i + 1]];
          copy.set(drawn.subarray(start, start + count), start);
        }
        assert.deepEqual(copy.subarray(0, drawn.length), drawn);
        assert.ok(drawn.every((index) => index < lod.order.length));
        counts.push(lod.triangles);
      }
      assert.ok(counts[0] < counts[1] && counts[1] < counts[2] && counts[5] < counts[2], `${counts}`);
      assert.equal(counts[3], counts[4]);
      lod.free();
    });
  }

  test('materials are groups', () => {
    const { positions, indices } = rock(40);
    const materials = new Uint32Array(indices.length / 3).map((_, i) => i % 2 ? 7 : 3).sort();
    const lod = new library.Lod(positions, indices, { materials });
    assert.equal(lod.groups, 2);
    assert.deepEqual([lod.material(0), lod.material(1)], [3, 7]);
    lod.addView(lookAt([0, 0, 1.2]), 0.8, 1920, 1080, 0);
    lod.adapt(0);
    assert.equal(lod.indices(0).length + lod.indices(1).length, 3 * lod.triangles);
    assert.equal(lod.indices(2).length, 0);
  });

  test('a budget is kept', () => {
    const { positions, indices } = rock(120);
    const lod = new library.Lod(positions, indices, { most: 1000 });
    for (let i = 0; i < 50; i++) {
      lod.addView(lookAt([0, 0, 1.5]), 0.8, 1920, 1080, 0.01);
      lod.adapt(1 / 60);
      assert.ok(lod.triangles <= 1000, `${lod.triangles}`);
    }
  });

  test('three.js draws what follows', async (t) => {
    const folder = mkdtempSync(join(tmpdir(), 'multires-three-'));
    t.after(() => rmSync(folder, { recursive: true, force: true }));
    let three;
    try {
      three = createRequire(join(process.env.MULTIRES_THREE ?? process.cwd(), 'package.json')).resolve('three');
    } catch {
      return t.skip('skipped: no three (npm install --prefix DIR three, MULTIRES_THREE=DIR)');
    }
    // As npm would lay them out.
    cpSync(join(three, '../..'), join(folder, 'node_modules/three'), { recursive: true });
    cpSync(npm, join(folder, 'node_modules/multires-web'), { recursive: true });
    const from = createRequire(join(folder, 'package.json'));
    const THREE = await import(pathToFileURL(join(folder, 'node_modules/three/build/three.module.js')));
    const web = await import(pathToFileURL(from.resolve('multires-web')));
    await web.default(readFileSync(join(npm, 'multires_bg.wasm')));
    const { follow } = await import(pathToFileURL(from.resolve('multires-web/three.js')));
    const mesh = new THREE.Mesh(new THREE.TorusKnotGeometry(1, 0.3, 400, 60));
    const full = mesh.geometry.index.count;
    const camera = new THREE.PerspectiveCamera(45, 16 / 9, 0.1, 100);
    const update = follow(mesh);
    const at = (z) => {
      camera.position.set(0, 0, z);
      camera.updateMatrixWorld();
      update(camera, [1280, 720], 1 / 60);
      return mesh.geometry.drawRange.count;
    };
    const [far, near] = [at(60), at(4)];
    assert.ok(far > 0 && far < near / 4 && near < full, `${far} ${near} ${full}`);
    const { position } = mesh.geometry.attributes;
    assert.ok(mesh.geometry.index.array.subarray(0, near).every((index) => index < position.count));
    assert.ok(mesh.geometry.index.updateRanges.length > 0);
  });

});
