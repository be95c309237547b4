// Draws a run: people as discs and capsules, all in two calls, walls, and a field of densities below them.
"use strict";

const FULL = { pressure: 600, speed: 2, wall: 6000, density: 8 };  // N/m, m/s, N/m, 1/m2: the red ends of the scales
const STOPS = [[70, 120, 180], [120, 190, 170], [250, 210, 90], [205, 40, 45]];
const element = (id) => document.getElementById(id);

const RAMP = Array.from({ length: 97 }, (_, step) => {
  const at = step / 32, i = Math.min(2, Math.floor(at));
  return STOPS[i].map((c, k) => Math.round(c + (at - i) * (STOPS[i + 1][k] - c)));
});
function rampStep(share) { return Math.round(96 * Math.min(Math.max(share, 0), 1)); }
function rampColour(share) { return RAMP[rampStep(share)]; }
// The colours of the ramp, and darker ones for rims, as pixels: four bytes each.
function pixelsOf(colours) { return new Uint32Array(Uint8Array.from(colours.flatMap((colour) => [...colour, 255])).buffer); }
const RIM_SHADE = 0.62, RAMP_PIXELS = pixelsOf(RAMP), RIM_PIXELS = pixelsOf(RAMP.map((colour) => colour.map((c) => RIM_SHADE * c)));

const raw = atob(recording);
const bytes = new Uint8Array(raw.length);
for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
const run = new Run(bytes);

const VERTEX = `
attribute vec4 ends; attribute float radius; attribute vec4 paint;
varying vec2 place; varying vec2 axis; varying float around; varying vec4 colour;
uniform float least;
void main() {
  vec2 middle = (ends.xy + ends.zw) * 0.5, half_axis = (ends.zw - ends.xy) * 0.5;
  around = max(radius, least); axis = half_axis; colour = paint;
  place = position.xy * (around + abs(half_axis) + least);
  gl_Position = projectionMatrix * viewMatrix * vec4(middle + place, 0.0, 1.0);
}`;
// The colour of a capsule is darker at its rim, unless it is tiny.
const FRAGMENT = `
precision highp float;
varying vec2 place; varying vec2 axis; varying float around; varying vec4 colour;
uniform float least;
void main() {
  float along = dot(axis, axis) > 0.0 ? clamp(dot(place, axis) / dot(axis, axis), -1.0, 1.0) : 0.0;
  float off = length(place - along * axis) - around;
  if (off > 0.0) discard;
  gl_FragColor = vec4(off > -1.5 * least && around > 4.0 * least ? ${RIM_SHADE} * colour.rgb : colour.rgb, colour.a);
}`;

const SQUARE = `
precision highp float;
varying vec4 colour;
void main() { gl_FragColor = colour; }`;

// Many capsules, or squares, in one call: four corners each, not instances, which browsers without a graphics card draw slowly.
class Capsules {
  constructor(scene, order, fragmentShader = FRAGMENT) {
    this.least = { value: 0.01 };
    this.material = new THREE.ShaderMaterial({ vertexShader: VERTEX, fragmentShader, uniforms: { least: this.least },
                                               transparent: true, depthTest: false });
    this.scene = scene;
    this.order = order;
    this.room = 0;
  }
  attribute(name, array, size, normalized = false) {
    this[name] = new THREE.BufferAttribute(array, size, normalized);
    this.geometry.setAttribute(name, this[name]);
  }
  reserve(count) {
    if (count <= this.room) return;
    this.room = Math.ceil(count * 1.2) + 16;
    this.geometry = new THREE.BufferGeometry();
    const corners = new Float32Array(12 * this.room), index = new Uint32Array(6 * this.room);
    for (let i = 0; i < this.room; ++i) {
      corners.set([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], 12 * i);
      index.set([0, 1, 2, 0, 2, 3].map((k) => 4 * i + k), 6 * i);
    }
    this.attribute("position", corners, 3);
    this.attribute("ends", new Float32Array(16 * this.room), 4);
    this.attribute("radius", new Float32Array(4 * this.room), 1);
    this.attribute("paint", new Uint8Array(16 * this.room), 4, true);
    this.geometry.setIndex(new THREE.BufferAttribute(index, 1));
    if (this.drawn) this.scene.remove(this.drawn);
    this.drawn = new THREE.Mesh(this.geometry, this.material);
    this.drawn.frustumCulled = false;
    this.drawn.renderOrder = this.order;
    this.scene.add(this.drawn);
  }
  set(i, x0, y0, x1, y1, radius, colour, alpha) {
    const ends = this.ends.array, paint = this.paint.array;
    for (let corner = 4 * i; corner < 4 * i + 4; ++corner) {
      const at = 4 * corner;
      ends[at] = x0;
      ends[at + 1] = y0;
      ends[at + 2] = x1;
      ends[at + 3] = y1;
      this.radius.array[corner] = radius;
      for (let k = 0; k < 3; ++k) paint[at + k] = colour[k];
      paint[at + 3] = 255 * alpha;
    }
  }
  show(count) {
    if (!this.drawn) return;
    this.geometry.setDrawRange(0, 6 * count);
    for (const attribute of [this.ends, this.radius, this.paint]) attribute.needsUpdate = true;
    this.drawn.visible = count > 0;
  }
}

// Discs of few pixels: put into a picture here, which is then drawn as one square. Without a graphics card a browser takes 50 ms
// for a hundred thousand of them as points.
class Dots {
  constructor(scene, order) {
    this.map = { value: null };
    const material = new THREE.ShaderMaterial({
      vertexShader: "varying vec2 at; void main() { at = 0.5 * position.xy + 0.5; gl_Position = vec4(position.xy, 0.0, 1.0); }",
      fragmentShader: "varying vec2 at; uniform sampler2D map; void main() { gl_FragColor = texture2D(map, at); }",
      uniforms: { map: this.map }, transparent: true, depthTest: false });
    this.drawn = new THREE.Mesh(new THREE.PlaneBufferGeometry(2, 2), material);
    this.drawn.frustumCulled = false;
    this.drawn.renderOrder = order;
    scene.add(this.drawn);
  }
  // Clears the picture, which has as many pixels as the view.
  clear(width, height) {
    if (this.map.value && this.width === width && this.height === height) {
      this.pixels.fill(0);
      return;
    }
    if (this.map.value) this.map.value.dispose();
    this.width = width;
    this.height = height;
    this.pixels = new Uint32Array(width * height);
    this.map.value = new THREE.DataTexture(new Uint8Array(this.pixels.buffer), width, height, THREE.RGBAFormat);
  }
  // A disc in pixels from the lower left corner; all pixels whose middles are in it.
  put(x, y, radius, step) {
    this.fill(x, y, radius, radius > 4 ? RIM_PIXELS[step] : RAMP_PIXELS[step]);
    if (radius > 4) this.fill(x, y, radius - 1.5, RAMP_PIXELS[step]);
  }
  fill(x, y, radius, pixel) {
    const { width, height, pixels } = this;
    if (x + radius < 0 || x - radius > width) return;
    const top = Math.min(height - 1, Math.floor(y + radius - 0.5));
    for (let row = Math.max(0, Math.ceil(y - radius - 0.5)); row <= top; ++row) {
      const off = row + 0.5 - y, half = Math.sqrt(Math.max(0, radius * radius - off * off));
      const end = row * width + Math.min(width - 1, Math.floor(x + half - 0.5));
      for (let at = row * width + Math.max(0, Math.ceil(x - half - 0.5)); at <= end; ++at) pixels[at] = pixel;
    }
  }
  show(count) {
    this.map.value.needsUpdate = true;
    this.drawn.visible = count > 0;
  }
}

// Without antialiasing, which does nothing here: shaders cut the shapes, not edges of triangles.
const renderer = new THREE.WebGLRenderer({ canvas: element("view"), antialias: false, preserveDrawingBuffer: true });
renderer.setClearColor(0xfafaf8);
const world = new THREE.Scene(), camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -10, 10);
const fields = new Capsules(world, 0, SQUARE), walls = new Capsules(world, 1), people = new Capsules(world, 2), ring = new Capsules(world, 3);
const dots = new Dots(world, 2), DOT_PIXELS = 12;  // larger discs are capsules: few are in view, and each has many pixels
const eye = { x: 0, y: 0, metres: 10 };  // middle of the view, and metres from its lower to its upper edge
let playing = false, time = 0, picked = -1, following = false, dirty = true, before = new Map();

function metresAPixel() { return eye.metres / element("view").clientHeight; }

function placeCamera() {
  const view = element("view"), width = view.clientWidth, height = view.clientHeight;
  renderer.setPixelRatio(window.devicePixelRatio || 1);
  renderer.setSize(width, height, false);
  const half = eye.metres / 2, across = half * width / height;
  Object.assign(camera, { left: -across, right: across, top: half, bottom: -half });
  camera.position.set(eye.x, eye.y, 1);
  camera.updateProjectionMatrix();
  for (const each of [fields, walls, people, ring]) each.least.value = metresAPixel();
}

// Everything in view, with some room for what lies over the picture.
function fit() {
  let low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  const take = (x, y) => {
    low = [Math.min(low[0], x), Math.min(low[1], y)];
    high = [Math.max(high[0], x), Math.max(high[1], y)];
  };
  for (let i = 0; i < run.count; ++i) take(run.ends[4 * i] / 1000, run.ends[4 * i + 1] / 1000);
  for (const wall of run.walls) { take(wall[0] / 1000, wall[1] / 1000); take(wall[2] / 1000, wall[3] / 1000); }
  if (!(low[0] <= high[0])) return;
  const view = element("view");
  eye.x = (low[0] + high[0]) / 2;
  eye.y = (low[1] + high[1]) / 2;
  eye.metres = 1.25 * Math.max(high[1] - low[1], (high[0] - low[0]) * view.clientHeight / view.clientWidth, 2);
}

// The speed of each shape, m/s, from the places in the frame before, which every call remembers.
function speeds() {
  const result = new Float64Array(run.count), now = new Map();
  const seconds = run.secondsAFrame * Math.max(1, run.frame - speeds.frame);
  for (let i = 0; i < run.count; ++i) {
    const x = run.ends[4 * i], y = run.ends[4 * i + 1], was = before.get(run.person[i]);
    if (was && run.frame > speeds.frame) result[i] = Math.hypot(x - was[0], y - was[1]) / 1000 / seconds;
    else if (was && run.frame === speeds.frame) result[i] = was[2];
    now.set(run.person[i], [x, y, result[i]]);
  }
  before = now;
  speeds.frame = run.frame;
  return result;
}
speeds.frame = -1;

// How far up the ramp what a shape belongs to is: discs, those who are one capsule, and ragdolls.
const MODELS = { disc: 0, capsule: 0.62, ragdoll: 1 };
function models() {
  const shapes = new Map();
  for (let i = 0; i < run.count; ++i) shapes.set(run.person[i], (shapes.get(run.person[i]) || 0) + 1);
  return (i) => shapes.get(run.person[i]) > 1 ? MODELS.ragdoll : run.isLong[i] ? MODELS.capsule : MODELS.disc;
}

// Each square metre of the plane that somebody is on: how many are, and the sum of the largest pressures on each, N/m.
function squareMetres() {
  const cells = new Map(), most = new Map();
  for (let i = 0; i < run.count; ++i) most.set(run.person[i], Math.max(run.pressure[i], most.get(run.person[i]) || 0));
  for (let i = 0; i < run.count; ++i) {
    if (!most.has(run.person[i])) continue;
    const x = Math.floor(run.ends[4 * i] / 1000), y = Math.floor(run.ends[4 * i + 1] / 1000), key = x + "," + y;
    if (!cells.has(key)) cells.set(key, { x, y, people: 0, pressure: 0 });
    ++cells.get(key).people;
    cells.get(key).pressure += most.get(run.person[i]);
    most.delete(run.person[i]);  // a person counts once
  }
  return cells;
}

function frameNow() { return Math.min(run.frames - 1, Math.floor(time / run.secondsAFrame + 1e-6)); }

function drawFrame() {
  const frame = frameNow();
  run.seek(frame);
  const colour = element("colour").value, speed = colour === "speed" ? speeds() : null;
  if (following && picked >= 0) {
    const i = run.find(picked);
    if (i >= 0) [eye.x, eye.y] = [run.ends[4 * i] / 1000, run.ends[4 * i + 1] / 1000];
  }
  placeCamera();
  if (colour === "model") drawPeople(models());
  else drawPeople(speed ? (i) => speed[i] / FULL.speed : (i) => run.pressure[i] / FULL.pressure);
  drawWalls();
  drawField();
  drawPicked();
  renderer.render(world, camera);
  element("clock").textContent = (frame * run.secondsAFrame).toFixed(1) + " of " + ((run.frames - 1) * run.secondsAFrame).toFixed(1) + " s";
  element("time").value = frame;
  dirty = false;
}

// Small discs as dots, and of all others those in view. `share` is how far up the ramp each shape's colour is.
function drawPeople(share) {
  const shapes = drawDots(share);
  const view = element("view"), up = eye.metres / 2, across = up * view.clientWidth / view.clientHeight;
  const outside = (a, b, radius, middle, half) => Math.max(a, b) + radius < middle - half || Math.min(a, b) - radius > middle + half;
  const place = (i) => [0, 1, 2, 3].map((k) => run.ends[4 * i + k] / 1000);
  const seen = shapes.filter((i) => {
    const [x0, y0, x1, y1] = place(i), radius = run.radius[i] / 1000;
    return !outside(x0, x1, radius, eye.x, across) && !outside(y0, y1, radius, eye.y, up);
  });
  people.reserve(seen.length);
  seen.forEach((i, at) => people.set(at, ...place(i), run.radius[i] / 1000, rampColour(share(i)), 1));
  people.show(seen.length);
}

// Draws small discs and returns which shapes are none. A hundred thousand are drawn here, so nothing is allocated for each.
function drawDots(share) {
  const { count, ends, radius, isLong } = run, canvas = element("view"), others = [];
  const pixels = canvas.height / eye.metres / 1000, small = DOT_PIXELS / 2 / pixels;  // pixels in a millimetre
  const left = canvas.width / 2 - 1000 * pixels * eye.x, low = canvas.height / 2 - 1000 * pixels * eye.y;
  dots.clear(canvas.width, canvas.height);
  for (let i = 0; i < count; ++i) {
    if (isLong[i] || radius[i] >= small) others.push(i);
    else dots.put(left + pixels * ends[4 * i], low + pixels * ends[4 * i + 1], Math.max(1, pixels * radius[i]), rampStep(share(i)));
  }
  dots.show(count - others.length);
  return others;
}

// A piece of a metre each, coloured by what presses on it.
function drawWalls() {
  let pieces = 0;
  run.walls.forEach((wall, w) => { pieces += Math.max(1, (run.wallPressures[w] || []).length); });
  walls.reserve(pieces);
  let at = 0;
  run.walls.forEach((wall, w) => {
    const bands = run.wallPressures[w] || [], [x0, y0, x1, y1] = wall.map((c) => c / 1000);
    const length = Math.hypot(x1 - x0, y1 - y0), count = Math.max(1, bands.length);
    for (let k = 0; k < count; ++k) {
      const a = count === 1 ? 0 : k / length, b = count === 1 ? 1 : Math.min(1, (k + 1) / length);
      const colour = bands[k] > 0 ? rampColour(bands[k] / FULL.wall) : [50, 50, 55];
      walls.set(at++, x0 + a * (x1 - x0), y0 + a * (y1 - y0), x0 + b * (x1 - x0), y0 + b * (y1 - y0),
                Math.max(0.03, 1.5 * metresAPixel()), colour, 1);
    }
  });
  walls.show(at);
}

// A square metre each: how many are on it, or the mean of the pressures on them.
function drawField() {
  const field = element("field").value;
  if (field === "none") { fields.show(0); return; }
  const cells = squareMetres();
  fields.reserve(cells.size);
  let at = 0;
  for (const { x, y, people, pressure } of cells.values()) {
    const colour = rampColour(field === "density" ? people / FULL.density : pressure / people / FULL.pressure);
    fields.set(at++, x + 0.5, y + 0.5, x + 0.5, y + 0.5, 0.5 - metresAPixel(), colour, 0.35);
  }
  fields.show(at);
}

function drawPicked() {
  const i = picked < 0 ? -1 : run.find(picked);
  element("picked").hidden = picked < 0;
  if (i < 0) { ring.show(0); element("now").textContent = picked < 0 ? "" : "not there now"; return; }
  ring.reserve(1);
  ring.set(0, run.ends[4 * i] / 1000, run.ends[4 * i + 1] / 1000, run.ends[4 * i + 2] / 1000, run.ends[4 * i + 3] / 1000,
           run.radius[i] / 1000 + 3 * metresAPixel(), [30, 30, 40], 0.45);
  ring.show(1);
  element("now").textContent = pressureOf(picked).toFixed(0) + " N/m at " +
      (run.ends[4 * i] / 1000).toFixed(2) + ", " + (run.ends[4 * i + 1] / 1000).toFixed(2) + " m";
  drawChart();
}

// The greatest pressure on any shape of a person now, N/m.
function pressureOf(person) {
  let most = 0;
  for (let i = 0; i < run.count; ++i) if (run.person[i] === person) most = Math.max(most, run.pressure[i]);
  return most;
}

// What the picked person bears in every frame, made once for each who is picked.
let history = { person: -1, values: [] };
function pick(person) {
  picked = person;
  dirty = true;
  if (person < 0) return;
  element("who").textContent = "person " + person;
  const frame = run.frame;
  history = { person, values: [] };
  for (let i = 0; i < run.frames; ++i) { run.seek(i); history.values.push(run.find(person) < 0 ? NaN : pressureOf(person)); }
  run.seek(frame);
}
function drawChart() {
  const chart = element("chart"), pen = chart.getContext("2d"), values = history.values;
  const most = Math.max(50, ...values.filter((v) => v === v));
  const x = (i) => 28 + (chart.width - 34) * i / Math.max(1, values.length - 1), y = (v) => chart.height - 14 - (chart.height - 24) * v / most;
  pen.clearRect(0, 0, chart.width, chart.height);
  pen.font = "10px system-ui, sans-serif";
  pen.fillStyle = "#77777f";
  pen.fillText(most.toFixed(0), 0, 14);
  pen.fillText("0", 0, chart.height - 12);
  pen.fillText("N/m over the run", 28, chart.height - 1);
  pen.strokeStyle = "#d8d8d4";
  pen.strokeRect(28, 10, chart.width - 34, chart.height - 24);
  pen.strokeStyle = "#2f6db5";
  pen.beginPath();
  let down = false;
  values.forEach((v, i) => {
    if (v !== v) { down = false; return; }
    down ? pen.lineTo(x(i), y(v)) : pen.moveTo(x(i), y(v));
    down = true;
  });
  pen.stroke();
  pen.strokeStyle = "#cd282d";
  pen.beginPath();
  pen.moveTo(x(run.frame), 10);
  pen.lineTo(x(run.frame), chart.height - 14);
  pen.stroke();
}

// Who is at a pixel: the nearest axis that is within its radius, or -1.
function personAt(px, py) {
  const view = element("view");
  const x = eye.x + (px - view.clientWidth / 2) * metresAPixel(), y = eye.y - (py - view.clientHeight / 2) * metresAPixel();
  let best = -1, least = Infinity;
  for (let i = 0; i < run.count; ++i) {
    const [x0, y0, x1, y1] = [0, 1, 2, 3].map((k) => run.ends[4 * i + k] / 1000), dx = x1 - x0, dy = y1 - y0;
    const share = dx * dx + dy * dy > 0 ? Math.min(1, Math.max(0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy))) : 0;
    const off = Math.hypot(x - x0 - share * dx, y - y0 - share * dy) - run.radius[i] / 1000;
    if (off < Math.max(0, 2 * metresAPixel()) && off < least) [best, least] = [run.person[i], off];
  }
  return best;
}

function drawLegend() {
  const ramp = element("ramp"), pen = ramp.getContext("2d");
  const blocks = element("colour").value === "model" ? Object.values(MODELS) : null;
  for (let x = 0; x < ramp.width; ++x) {
    const share = x / (ramp.width - 1);
    pen.fillStyle = "rgb(" + rampColour(blocks ? blocks[Math.min(2, Math.floor(3 * share))] : share).join() + ")";
    pen.fillRect(x, 0, 1, ramp.height);
  }
  const scales = { speed: "0 to " + FULL.speed + " m/s", pressure: "0 to " + FULL.pressure + " N per m of circumference",
                   model: "from left to right: discs, single capsules, ragdolls" };
  const fieldScales = { none: "", density: "; cells to " + FULL.density + " per m2", pressure: "; cells to " + FULL.pressure + " N/m in the mean" };
  element("scale").textContent = scales[element("colour").value] + "; walls to " + FULL.wall / 1000 + " kN/m" + fieldScales[element("field").value];
}

function play(on) { playing = on; element("play").textContent = on ? "pause" : "play"; }
element("play").onclick = () => {
  if (!playing && time >= (run.frames - 1) * run.secondsAFrame) time = 0;
  play(!playing);
};
element("time").max = run.frames - 1;
element("time").oninput = () => { time = Number(element("time").value) * run.secondsAFrame; play(false); dirty = true; };
element("colour").onchange = element("field").onchange = () => { drawLegend(); dirty = true; };
element("follow").onclick = () => { following = !following; element("follow").textContent = following ? "stay" : "follow"; dirty = true; };
element("leave").onclick = () => { following = false; element("follow").textContent = "follow"; pick(-1); };
const view = element("view");
let held = null;
view.onmousedown = (event) => { held = { x: event.clientX, y: event.clientY, moved: false }; };
window.onmousemove = (event) => {
  if (!held) return;
  const dx = event.clientX - held.x, dy = event.clientY - held.y;
  if (!held.moved && Math.hypot(dx, dy) < 4) return;
  eye.x -= dx * metresAPixel();
  eye.y += dy * metresAPixel();
  held = { x: event.clientX, y: event.clientY, moved: true };
  dirty = true;
};
window.onmouseup = (event) => {
  if (held && !held.moved && event.target === view) pick(personAt(event.clientX, event.clientY));
  held = null;
};
view.onwheel = (event) => { eye.metres *= Math.exp(0.001 * event.deltaY); dirty = true; event.preventDefault(); };
window.onresize = () => { dirty = true; };
window.onkeydown = (event) => { if (event.key === " " && event.target === document.body) element("play").onclick(); };

let shown = 0, last = performance.now(), began = last;
function tick(now) {
  if (playing) {
    time = Math.min(time + (now - last) / 1000 * Number(element("rate").value), (run.frames - 1) * run.secondsAFrame);
    if (frameNow() !== run.frame) dirty = true;
    if (time >= (run.frames - 1) * run.secondsAFrame) {
      play(false);
      if (window.location.hash === "#play") console.info("played " + JSON.stringify({ frames: shown, seconds: (now - began) / 1000 }));
    }
  }
  last = now;
  if (dirty) { drawFrame(); ++shown; }
  window.requestAnimationFrame(tick);
}

// What a test asks, with page.html#check, and reads in the console: numbers of the run as the page has them, whether picking finds
// who is there, and the time of a frame.
function check() {
  const gl = renderer.getContext(), seen = { people: 0, pressures: 0 };
  for (let i = 0; i < run.frames; ++i) {
    run.seek(i);
    seen.people += run.count;
    for (let k = 0; k < run.count; ++k) seen.pressures += run.pressure[k];
  }
  let found = 0, tried = 0;
  time = (run.frames - 1) * run.secondsAFrame;
  drawFrame();
  for (let k = 0; k < run.count; k += Math.max(1, Math.floor(run.count / 20))) {
    const px = (run.ends[4 * k] / 1000 - eye.x) / metresAPixel() + view.clientWidth / 2;
    const py = view.clientHeight / 2 - (run.ends[4 * k + 1] / 1000 - eye.y) / metresAPixel();
    ++tried;
    found += personAt(px, py) === run.person[k] ? 1 : 0;
  }
  pick(run.person[0]);
  for (const colour of ["model", "speed", "pressure"]) {
    for (const field of ["density", "pressure", "none"]) {
      [element("colour").value, element("field").value] = [colour, field];
      drawLegend();
      drawFrame();
    }
  }
  const on_cells = [...squareMetres().values()].reduce((sum, cell) => sum + cell.people, 0) === new Set(run.person).size ? 1 : 0;
  const began = performance.now(), draws = 20;
  for (let i = 0; i < draws; ++i) { time = run.secondsAFrame * Math.min(i, run.frames - 1); drawFrame(); gl.finish(); }
  const milliseconds = (performance.now() - began) / draws;
  time = 0;
  drawFrame();
  const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let coloured = 0;
  for (let i = 0; i < pixels.length; i += 4) coloured += Math.abs(pixels[i] - pixels[i + 2]) > 20 ? 1 : 0;
  console.info("check " + JSON.stringify({ frames: run.frames, people: seen.people, pressures: seen.pressures, found, tried, coloured, on_cells,
                                           milliseconds, gl_error: gl.getError(), history: history.values.length }));
}

element("scene").textContent = run.scene;
element("facts").textContent = "";
if (run.frames > 0) {
  run.seek(0);
  element("facts").textContent = run.count + " people, " + ((run.frames - 1) * run.secondsAFrame).toFixed(1) + " s, a frame each " +
      (1000 * run.secondsAFrame).toFixed(0) + " ms";
  fit();
  drawLegend();
  drawFrame();
  if (window.location.hash === "#check") check();
  if (window.location.hash === "#play") play(true);
  window.requestAnimationFrame(tick);
}
