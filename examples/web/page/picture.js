// Has the canvas: every frame the scene adapts, uploads what changed, and is drawn. At rest nothing is done.

let program;
let stage;
let canvas;
// What came before the card was open.
let waiting = [];
let wants = false;
let turns = false;
let isFirst = true;
let last = 0;
let look = { wire: false, dark: false };

function frame(now) {
  const seconds = Math.min((now - last) / 1000, 0.1);
  last = now;
  try {
    if (turns) {
      stage.turn(0.25 * seconds, 0);
      stage.zoom(Math.exp(0.5 * Math.cos(now / 2500) * seconds));
    }
    const start = performance.now();
    const change = stage.adapt(seconds);
    const { triangles, operations, moving } = change;
    change.free();
    const adapted = performance.now();
    const bytes = stage.upload();
    const uploaded = performance.now();
    stage.draw();
    wants = moving || turns || operations > 0;
    postMessage({
      type: 'frame', triangles, bytes, rests: !wants, first: isFirst,
      adapt: 1000 * (adapted - start), upload: 1000 * (uploaded - adapted),
    });
    isFirst = false;
  } catch (error) {
    wants = false;
    postMessage({ type: 'failed', message: error.message });
  }
  if (wants) requestAnimationFrame(frame);
}

// Draws the next frame, if it would not be drawn anyway.
function wake() {
  if (!stage || isFirst && stage.full === 0 || wants) return;
  wants = true;
  last = performance.now();
  requestAnimationFrame(frame);
}

const setters = {
  tolerance: (value) => stage.set_tolerance(value),
  budget: (value) => stage.set_budget(value),
  geomorph: (value) => stage.set_geomorph(value),
  freeze: (value) => stage.freeze(value),
  shading: (value) => stage.set_shading(value),
  wire: (value) => stage.set_look(look.wire = value, look.dark),
  dark: (value) => stage.set_look(look.wire, look.dark = value),
  turn: (value) => { turns = value; },
};

const handlers = {
  async open({ by, module, canvas: given, width, height }) {
    program = await import(`./multires_${by}.js`);
    program.initSync({ module });
    canvas = given;
    canvas.width = width;
    canvas.height = height;
    stage = await program.Stage.open(canvas);
    postMessage({ type: 'opened', card: stage.card() });
    for (const message of waiting.splice(0)) handle(message);
  },
  show({ baked, scene, pictures: [colours, normals], isPainted }) {
    const pictures = new program.Pictures(colours.pixels, colours.width, normals.pixels, normals.width, isPainted);
    stage.show(baked, scene, pictures);
    postMessage({ type: 'shown', full: stage.full, shading: stage.shading() });
  },
  set({ key, value }) {
    setters[key](value);
  },
  move({ turn, pan, zoom }) {
    turns = false;
    if (turn) stage.turn(...turn);
    if (pan) stage.pan(...pan);
    if (zoom) stage.zoom(zoom);
  },
  home() {
    turns = false;
    stage.home();
  },
  resize({ width, height }) {
    stage.resize(width, height);
  },
  async snapshot() {
    stage.start_reading();
    let pixels;
    while (!(pixels = stage.read())) await new Promise((resolve) => setTimeout(resolve, 5));
    const paper = new OffscreenCanvas(canvas.width, canvas.height);
    const image = new ImageData(new Uint8ClampedArray(pixels), canvas.width, canvas.height);
    paper.getContext('2d').putImageData(image, 0, 0);
    postMessage({ type: 'snapshot', blob: await paper.convertToBlob() });
  },
};

async function handle(message) {
  try {
    await handlers[message.type](message);
    wake();
  } catch (error) {
    postMessage({ type: 'failed', message: error.message });
  }
}

onmessage = ({ data }) => {
  if (stage || data.type === 'open') handle(data);
  else waiting.push(data);
};
