// Builds baked models out of the way of everything else.

import { initSync, build } from './multires_build.js';

let ready = false;

onmessage = ({ data: { module, name, bytes, structure } }) => {
  try {
    if (!ready) initSync({ module });
    ready = true;
    const built = build(name, bytes, structure, (share) => postMessage({ type: 'progress', share }));
    const { triangles, warnings } = built;
    const baked = built.take();
    built.free();
    postMessage({ type: 'built', baked, triangles, warnings }, [baked.buffer]);
  } catch (error) {
    postMessage({ type: 'failed', message: `${name}: ${error.message}` });
  }
};
