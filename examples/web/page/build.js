// Builds baked models out of the way of everything else.

import { initSync, build } from './multires_build.js';

let ready = false;

onmessage = ({ data: { module, name, bytes, structure } }) => {
  try {
    if (!ready) initSync({ module });
    ready = true;
    const built = build(name, bytes, structure, (share) => postMessage({ type: 'progress', share }));
    const { triangles, warnings, is_painted: isPainted } = built;
    const baked = built.take();
    const pictures = [0, 1].map((which) => ({ width: built.width(which), pixels: built.take_picture(which) }));
    built.free();
    const parts = [baked, ...pictures.map((picture) => picture.pixels)];
    postMessage({ type: 'built', baked, pictures, isPainted, triangles, warnings }, parts.map((part) => part.buffer));
  } catch (error) {
    postMessage({ type: 'failed', message: `${name}: ${error.message}` });
  }
};
