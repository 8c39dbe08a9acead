// What is seen and touched. All work is done by two workers: one has the canvas, one builds.

const byId = (id) => document.getElementById(id);
const asked = new URLSearchParams(location.search);
const canvas = byId('canvas');
const view = byId('view');
const body = document.body;

// --- what frames told, for the curves and for whoever looks into it ---

const SAMPLES = 240;
const frames = [];
let taken = () => {};
// The picture as PNG.
const snapshot = () => new Promise((resolve) => { taken = resolve; picture.postMessage({ type: 'snapshot' }); });
globalThis.multires = { frames, card: '', firstPicture: 0, snapshot };

// --- workers ---

const picture = new Worker('picture.js', { type: 'module' });
let builder;
let building = null;

const compile = (name) => WebAssembly.compileStreaming(fetch(`${name}_bg.wasm`));
// A program for each way to draw: the one for WebGPU is half as large.
const hasWebGpu = async () => Boolean(await navigator.gpu?.requestAdapter().catch(() => null));
const draws = async () => asked.get('backend') ?? (await hasWebGpu() ? 'webgpu' : 'webgl');
const notStarted = (error) => fail(`The page could not be started: ${error.message}`);
draws().then(async (by) => {
  const module = await compile(`multires_${by}`);
  const off = canvas.transferControlToOffscreen();
  const [width, height] = pixels();
  picture.postMessage({ type: 'open', by, module, canvas: off, width, height }, [off]);
}).catch(notStarted);
// What builds is loaded when something is to be built, or when the first picture is there.
let buildModule;
const loadBuilder = () => {
  buildModule ??= compile('multires_build');
  return buildModule;
};

function newBuilder() {
  builder?.terminate();
  builder = new Worker('build.js', { type: 'module' });
  builder.onmessage = ({ data }) => {
    if (data.type === 'progress') progress(data.share);
    else if (data.type === 'built') show(data);
    else fail(data.message);
  };
  builder.onerror = (event) => fail(`The build ended: ${event.message ?? 'out of memory'}`);
}

picture.onmessage = ({ data }) => {
  if (data.type === 'opened') {
    globalThis.multires.card = data.card;
    byId('card').textContent = `Drawn by ${data.card}`;
  } else if (data.type === 'shown') {
    building = null;
    body.dataset.state = 'shown';
    loadBuilder().catch(notStarted);
    byId('full').textContent = count(data.full);
    byId('shading').value = data.shading;
  } else if (data.type === 'snapshot') {
    taken(data.blob);
  } else if (data.type === 'frame') {
    framed(data);
  } else {
    fail(data.message);
  }
};
picture.onerror = (event) => fail(`The picture ended: ${event.message ?? 'out of memory'}`);

// --- models ---

// Builds a scene (a name) or a file; a build on its way ends.
async function load(name, bytes, structure) {
  body.dataset.state = 'loading';
  byId('alert').hidden = true;
  byId('loading-what').textContent = `Building ${name}`;
  progress(0);
  if (building && builder) newBuilder();
  building = { scene: bytes ? '' : name };
  for (const button of document.querySelectorAll('[data-scene]')) {
    button.setAttribute('aria-pressed', String(button.dataset.scene === building.scene));
  }
  const asked = building;
  try {
    if (name === 'demo' && !bytes && structure === 'hierarchy') {
      const baked = new Uint8Array(await (await fetch('demo.mres')).arrayBuffer());
      const none = () => ({ width: 0, pixels: new Uint8Array() });
      if (asked === building) show({ baked, pictures: [none(), none()], isPainted: false, warnings: [] });
      return;
    }
    const module = await loadBuilder();
    if (asked !== building) return;
    if (!builder) newBuilder();
    builder.postMessage({ module, name, bytes, structure });
  } catch (error) {
    if (asked === building) notStarted(error);
  }
}

function show({ baked, pictures, isPainted, warnings }) {
  if (!building) return;
  if (warnings.length > 0) say(warnings.join('; '));
  const parts = [baked, ...pictures.map((picture) => picture.pixels)];
  picture.postMessage({ type: 'show', baked, pictures, isPainted, scene: building.scene }, parts.map((part) => part.buffer));
}

function loadScene(scene) {
  const structure = scene === 'crowd' ? 'gmesh' : byId('structure').value;
  if (scene === 'crowd') byId('structure').value = 'gmesh';
  last = () => load(scene, undefined, byId('structure').value);
  load(scene, undefined, structure);
}

async function loadFile(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  if (byId('structure').value === 'wavelet') byId('structure').value = 'hierarchy';
  last = () => load(file.name, bytes, byId('structure').value);
  last();
}

let last = () => {};

// --- messages ---

function say(text) {
  byId('alert-text').textContent = text;
  byId('alert').hidden = false;
}

function fail(message) {
  building = null;
  body.dataset.state = 'failed';
  say(message);
}

function progress(share) {
  byId('progress').value = share;
}

byId('alert-close').onclick = () => { byId('alert').hidden = true; };

// --- settings ---

const count = (n) => Math.round(n).toLocaleString('en');
const set = (key, value) => picture.postMessage({ type: 'set', key, value });

const settings = {
  tolerance: (at) => {
    const pixels = 2 ** at;
    byId('tolerance-value').textContent = `${pixels.toPrecision(2)} px`;
    set('tolerance', pixels);
  },
  budget: (at) => {
    const triangles = at >= 6 ? 0 : Math.round(10 ** at);
    byId('budget-value').textContent = triangles ? count(triangles) : 'any';
    set('budget', triangles);
  },
  geomorph: (seconds) => {
    byId('geomorph-value').textContent = seconds > 0 ? `${seconds.toFixed(2)} s` : 'off';
    set('geomorph', seconds);
  },
};
for (const [id, apply] of Object.entries(settings)) {
  const input = byId(id);
  if (asked.has(id)) input.value = id === 'tolerance' ? Math.log2(asked.get(id)) : asked.get(id);
  input.oninput = () => apply(Number(input.value));
  apply(Number(input.value));
}
for (const id of ['wire', 'freeze']) {
  byId(id).checked = asked.get(id) === '1';
  byId(id).onchange = () => set(id, byId(id).checked);
  set(id, byId(id).checked);
}
byId('shading').onchange = () => set('shading', byId('shading').value);
byId('shading').value = asked.get('shading') ?? 'level';
set('shading', byId('shading').value);
if (asked.has('structure')) byId('structure').value = asked.get('structure');
byId('structure').onchange = () => last();
byId('home').onclick = () => picture.postMessage({ type: 'home' });

const dark = matchMedia('(prefers-color-scheme: dark)');
const theme = () => set('dark', asked.has('dark') ? asked.get('dark') === '1' : dark.matches);
dark.onchange = () => { theme(); curves(); };
theme();
set('turn', asked.get('turn') !== '0' && !matchMedia('(prefers-reduced-motion: reduce)').matches);
if (asked.get('panel') === '0') body.classList.add('bare');

for (const button of document.querySelectorAll('[data-scene]')) button.onclick = () => loadScene(button.dataset.scene);
byId('open').onclick = () => byId('file').click();
byId('file').onchange = () => { if (byId('file').files[0]) loadFile(byId('file').files[0]); };

addEventListener('dragover', (event) => { event.preventDefault(); byId('drop').hidden = false; });
addEventListener('dragleave', (event) => { if (!event.relatedTarget) byId('drop').hidden = true; });
addEventListener('drop', (event) => {
  event.preventDefault();
  byId('drop').hidden = true;
  if (event.dataTransfer.files[0]) loadFile(event.dataTransfer.files[0]);
});

// --- hands ---

const move = (message) => {
  body.classList.add('touched');
  picture.postMessage({ type: 'move', ...message });
};
const pointers = new Map();
canvas.onpointerdown = (event) => {
  canvas.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, [event.clientX, event.clientY]);
};
canvas.onpointerup = canvas.onpointercancel = (event) => pointers.delete(event.pointerId);
canvas.oncontextmenu = (event) => event.preventDefault();
canvas.onpointermove = (event) => {
  const before = pointers.get(event.pointerId);
  if (!before) return;
  const now = [event.clientX, event.clientY];
  const high = view.clientHeight;
  if (pointers.size >= 2) {
    const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
    const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
    const half = [(now[0] - before[0]) / 2, (now[1] - before[1]) / 2];
    move({ zoom: apart(now) / Math.max(apart(before), 1), pan: [-half[0] / high, half[1] / high] });
  } else if (event.buttons & 6 || event.shiftKey) {
    move({ pan: [(before[0] - now[0]) / high, (now[1] - before[1]) / high] });
  } else {
    move({ turn: [(before[0] - now[0]) * 4 / high, (now[1] - before[1]) * 4 / high] });
  }
  pointers.set(event.pointerId, now);
};
canvas.addEventListener('wheel', (event) => {
  event.preventDefault();
  const lines = event.deltaMode === 1 ? 16 : 1;
  move({ zoom: Math.exp(-event.deltaY * lines * 0.0015) });
}, { passive: false });
canvas.ondblclick = () => picture.postMessage({ type: 'home' });
canvas.onkeydown = (event) => {
  const step = 0.08;
  const moves = {
    ArrowLeft: { turn: [-step, 0] }, ArrowRight: { turn: [step, 0] }, ArrowUp: { turn: [0, step] }, ArrowDown: { turn: [0, -step] },
    '+': { zoom: 1.1 }, '=': { zoom: 1.1 }, '-': { zoom: 1 / 1.1 },
  };
  if (event.key === '0') picture.postMessage({ type: 'home' });
  else if (moves[event.key]) move(moves[event.key]);
  else return;
  event.preventDefault();
};

function pixels() {
  const ratio = Math.min(devicePixelRatio, 2);
  return [view.clientWidth, view.clientHeight].map((side) => Math.max(1, Math.round(side * ratio)));
}
new ResizeObserver(() => {
  const [width, height] = pixels();
  picture.postMessage({ type: 'resize', width, height });
}).observe(view);

// --- curves ---

let told = 0;
function framed({ triangles, adapt, upload, bytes, rests, first }) {
  if (first) globalThis.multires.firstPicture = performance.now();
  frames.push({ triangles, adapt, upload, bytes });
  if (frames.length > 4 * SAMPLES) frames.splice(0, frames.length - 2 * SAMPLES);
  body.dataset.rests = String(rests);
  byId('triangles').textContent = count(triangles);
  body.dataset.triangles = triangles;
  const now = performance.now();
  if (now - told > 60 || rests) {
    told = now;
    curves();
  }
}

// A line of the last frames, from 0 to the largest value.
function curve(context, width, height, values, most, colour) {
  context.strokeStyle = colour;
  context.lineWidth = 1.5 * Math.min(devicePixelRatio, 2);
  context.beginPath();
  values.forEach((value, i) => context.lineTo(width * (1 - (values.length - 1 - i) / (SAMPLES - 1)), height - 2 - (height - 4) * value / most));
  context.stroke();
}

function curves() {
  const shown = frames.slice(-SAMPLES);
  if (shown.length === 0) return;
  const style = getComputedStyle(document.documentElement);
  const colours = ['--accent', '--second'].map((name) => style.getPropertyValue(name));
  const draw = (id, lines) => {
    const canvas = byId(id);
    const ratio = Math.min(devicePixelRatio, 2);
    const [width, height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio].map(Math.round);
    if (width === 0) return;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext('2d');
    context.clearRect(0, 0, width, height);
    const most = Math.max(1, ...lines.flat());
    lines.forEach((values, i) => curve(context, width, height, values, most, colours[i]));
  };
  draw('drawn', [shown.map((frame) => frame.triangles)]);
  draw('times', [shown.map((frame) => frame.adapt), shown.map((frame) => frame.upload)]);
  const latest = shown[shown.length - 1];
  byId('drawn-now').textContent = count(latest.triangles);
  byId('adapt-now').textContent = count(latest.adapt);
  byId('upload-now').textContent = count(latest.upload);
}

loadScene(asked.get('scene') ?? 'demo');
