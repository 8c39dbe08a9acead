// Meshes and cameras for tests and measurements.

import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

export const root = join(dirname(fileURLToPath(import.meta.url)), '../..');
export const npm = join(process.env.CARGO_TARGET_DIR ?? join(root, 'target'), 'web/npm');

// A bumpy ball with a seam: 4 n^2 triangles, less those at the poles.
export function rock(n) {
  const [across, down] = [2 * n, n];
  const positions = [];
  const uvs = [];
  for (let j = 0; j <= down; j++) {
    for (let i = 0; i <= across; i++) {
      const [u, v] = [i / across, j / down];
      const [around, above] = [2 * Math.PI * (i % across) / across, Math.PI * v];
      const p = [Math.sin(above) * Math.cos(around), Math.cos(above), Math.sin(above) * Math.sin(around)];
      const bump = 1 + 0.1 * Math.sin(5 * p[0]) * Math.sin(6 * p[1]) * Math.sin(4 * p[2] + 1) + 0.01 * Math.sin(40 * p[0]) * Math.sin(37 * p[2]);
      positions.push(...p.map((x) => j === 0 || j === down ? (x > 0.5 ? 1 : x < -0.5 ? -1 : 0) : x * bump));
      uvs.push(u, v);
    }
  }
  const indices = [];
  const at = (i, j) => j * (across + 1) + i;
  for (let j = 0; j < down; j++) {
    for (let i = 0; i < across; i++) {
      const [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
      if (j > 0) indices.push(a, b, c);
      if (j < down - 1) indices.push(b, d, c);
    }
  }
  const normals = positions.map((x, i) => {
    const start = i - i % 3;
    return x / Math.hypot(...positions.slice(start, start + 3));
  });
  return {
    positions: new Float32Array(positions), normals: new Float32Array(normals), uvs: new Float32Array(uvs), indices: new Uint32Array(indices),
  };
}

// From the world to an eye that looks at the origin, from along z.
export function lookAt([x, y, z]) {
  return new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -y, -z, 1]);
}
