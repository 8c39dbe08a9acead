import { BufferAttribute, Matrix4 } from 'three';
import { Lod } from 'multires-web';

// Lets a mesh follow a camera: call what is returned before every frame is rendered.
export function follow(mesh, tolerance = 1) {
  const { attributes: { position, normal, uv }, attributes, index } = mesh.geometry;
  const lod = new Lod(position.array, new Uint32Array(index.array), { normals: normal?.array, uvs: uv?.array });
  for (const [name, { array, itemSize, normalized }] of Object.entries(attributes)) {
    mesh.geometry.setAttribute(name, new BufferAttribute(lod.arrange(array, itemSize), itemSize, normalized));
  }
  const drawn = new BufferAttribute(new Uint32Array(3 * lod.fullTriangles), 1);
  mesh.geometry.setIndex(drawn);
  return (camera, [width, height], seconds) => {
    const { elements } = new Matrix4().multiplyMatrices(camera.matrixWorldInverse, mesh.matrixWorld);
    lod.addView(new Float32Array(elements), camera.fov * Math.PI / 180, width, height, tolerance);
    if (!lod.adapt(seconds)) return;
    drawn.array.set(lod.indices());
    const changed = lod.changed(0);
    for (let i = 0; i < changed.length; i += 2) drawn.addUpdateRange(changed[i], changed[i + 1]);
    drawn.needsUpdate = true;
    mesh.geometry.setDrawRange(0, 3 * lod.triangles);
  };
}
