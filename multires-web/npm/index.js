// The bindings, and what cannot be said in them: views of their memory, and attributes of any type.

import init, { initSync, Lod as Bound, simplify } from './multires.js';

export { simplify };

let memory;

// Loads the module: from beside this file, or what is given (a URL, a Response, bytes, or a WebAssembly.Module).
export default async function start(source) {
  const exports = source instanceof WebAssembly.Module || source instanceof ArrayBuffer || ArrayBuffer.isView(source)
    ? initSync({ module: source })
    : await init(source === undefined ? undefined : { module_or_path: source });
  memory = exports.memory;
}

export class Lod extends Bound {
  #order;

  indices(group = 0) {
    const [at, count] = this.place(group);
    return new Uint32Array(memory.buffer, at, count);
  }

  arrange(values, width) {
    this.#order ??= this.order;
    const arranged = new values.constructor(this.#order.length * width);
    this.#order.forEach((from, to) => {
      for (let i = 0; i < width; i++) arranged[to * width + i] = values[from * width + i];
    });
    return arranged;
  }
}
