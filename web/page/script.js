'use strict';

const $ = (id) => document.getElementById(id);
const rgb = (bytes) => `rgb(${bytes.join(' ')})`;

/* ---- The core, in WebAssembly: text in, JSON out. ---- */

let core;
let catalogue;

async function start() {
  const bytes = Uint8Array.from(atob($('wasm').textContent.trim()), (c) => c.charCodeAt(0));
  core = (await WebAssembly.instantiate(bytes)).instance.exports;
  catalogue = ask('catalogue');
}

function ask(question, ...numbers) {
  core[question](...numbers);
  const answer = new Uint8Array(core.memory.buffer, core.output(), core.output_length());
  return JSON.parse(new TextDecoder().decode(answer));
}

function askOfFile(name, content) {
  const title = new TextEncoder().encode(name);
  const place = core.input(title.length + content.length);
  const room = new Uint8Array(core.memory.buffer, place, title.length + content.length);
  room.set(title);
  room.set(content, title.length);
  return ask('load', title.length);
}

/* ---- Small tools. ---- */

/** An element with attributes and children, text among them. */
function make(name, attributes = {}, ...children) {
  const space = svgNames.has(name) ? 'http://www.w3.org/2000/svg' : 'http://www.w3.org/1999/xhtml';
  const element = document.createElementNS(space, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}
const svgNames = new Set(['svg', 'g', 'path', 'rect', 'line', 'text', 'tspan', 'defs', 'linearGradient', 'stop', 'title', 'circle']);

/** A number as people read it; what it is exactly stays with it. */
function number(key, value, text) {
  if (value === null || value === undefined) return make('data', { 'data-key': key, value: '' }, '–');
  return make('data', { 'data-key': key, value: String(value) }, text(value));
}
const fixed = (digits) => (value) => value.toFixed(digits).replace('-', '−');
const signed = (digits) => (value) => (value < 0 ? '' : '+') + fixed(digits)(value);
const kelvin = (value) => `${value.toFixed(0)} K`;

/** What was said last is said when nothing has followed for a while. */
let saying;
function say(text) {
  clearTimeout(saying);
  saying = setTimeout(() => { $('status').textContent = text; }, 300);
}

/* ---- The lamp. ---- */

let lamp = null;

function show(loaded) {
  lamp = loaded;
  const { report, srgb } = loaded;
  refuse(null);
  $('results').hidden = false;
  $('lamp').style.background = rgb(srgb);
  $('light-title').textContent = report.light;
  const last = report.grid.first + report.grid.step * (report.grid.count - 1);
  $('grid').textContent = `Summed over ${report.grid.first}–${last} nm at ${report.grid.step} nm: ${report.grid.from}.`;
  facts(report);
  rendering(report);
  examine();
}

function facts(r) {
  const one = (label, ...values) => make('div', {}, make('dt', {}, ...label), make('dd', {}, ...values));
  const main = (label, value) => make('span', {}, make('dt', {}, ...label), make('dd', {}, value));
  const sub = (text) => make('sub', {}, text);
  const rows = [
    make('div', { class: 'main' },
      main(['colour temperature'], number('cct', r.cct, kelvin)),
      main(['R', sub('a')], number('ra', r.ra, fixed(1))),
      main(['CRI00'], number('cri00_munsell', r.cri00_munsell, fixed(1)))),
    one(['D', sub('uv')], number('duv', r.duv, signed(4))),
    one(['x, y'], number('x', r.xy[0], fixed(4)), ', ', number('y', r.xy[1], fixed(4))),
    one(['R', sub('f')], number('rf', r.rf, fixed(1))),
    one(['R', sub('g')], number('rg', r.rg, fixed(1))),
    one(['efficacy'], number('luminous_efficacy', r.luminous_efficacy, fixed(0)), make('small', {}, ' lm/W')),
    one(['melanopic DER'], number('melanopic_der', r.melanopic_der, fixed(3))),
    one(['circadian a', sub('cv')], number('acv', r.acv, fixed(3))),
    one(['R', sub('9')], number('r9', r.r ? r.r[8] : null, fixed(1))),
  ];
  const worth = {
    'far-from-locus': 'Far from white: a colour temperature describes this light badly, and so do the indices.',
    'below-range': 'The colour temperature is below the range of the indices.',
    'above-range': 'The colour temperature is above the range of the indices.',
  }[r.cct_status];
  if (worth) rows.push(make('p', { class: 'warn hint' }, worth));
  $('facts').replaceChildren(...rows);
}

function rendering(r) {
  $('reference').textContent = r.reference
    ? `Fourteen samples under the lamp, against a ${r.reference.kind === 'planckian' ? 'black body' : 'phase of daylight'} of ${kelvin(r.reference.temperature)}. Bars: R of CIE 13.3; diamonds: CRI00.`
    : 'There is no reference light of this colour temperature, and so there are no indices.';
  const rows = (r.r || []).map((value, i) => make('tr', {},
    make('th', { scope: 'row' }, String(i + 1)),
    make('td', {}, number(`r${i + 1}`, value, fixed(1))),
    make('td', {}, number(`cri00_${i + 1}`, r.cri00_munsell_i[i], fixed(1)))));
  $('indices').tBodies[0].replaceChildren(...rows);
  drawBars();
}

/* ---- Charts. ---- */

/** A chart as wide as its place, so that its letters have one size. */
function chart(place, height, label) {
  const width = Math.max(280, place.clientWidth);
  const svg = make('svg', { viewBox: `0 0 ${width} ${height}`, height, role: 'img', 'aria-label': label });
  place.replaceChildren(svg);
  return [svg, width];
}

function drawBars() {
  const { r, cri00_munsell_i: special } = lamp.report;
  if (!r) { $('bars').replaceChildren(); return; }
  const height = 240, left = 34, bottom = 24, top = 24;
  const label = `R1 to R14: ${r.map(fixed(0)).join(', ')}`;
  const [svg, width] = chart($('bars'), height, label);
  const low = Math.min(0, Math.floor(Math.min(...r, ...special) / 50) * 50);
  const lowest = Math.max(low, -150);
  const y = (value) => top + (100 - Math.max(value, lowest)) / (100 - lowest) * (height - top - bottom);
  for (let value = lowest; value <= 100; value += lowest < 0 ? 50 : 25) {
    svg.append(make('line', { class: value === 0 ? 'axis' : 'rule', x1: left, x2: width, y1: y(value), y2: y(value) }),
      make('text', { x: left - 6, y: y(value) + 4, 'text-anchor': 'end' }, fixed(0)(value)));
  }
  const step = (width - left) / 14;
  r.forEach((value, i) => {
    const x = left + i * step, middle = x + step / 2, [from, to] = [y(Math.max(value, 0)), y(Math.min(value, 0))];
    svg.append(make('rect', { x: x + step * 0.14, width: step * 0.72, y: from, height: Math.max(1, to - from), rx: 2, fill: rgb(catalogue.samples[i]) }));
    const s = y(special[i]);
    // Above the diamond, too, where that is at the bar's end.
    const above = Math.abs(s - from) < 22 ? Math.min(from, s - 4) : from;
    if (step > 27) svg.append(make('text', { class: 'strong', x: middle, y: above - 5, 'text-anchor': 'middle' }, fixed(0)(value)));
    svg.append(make('path', { class: 'special', d: `M${middle} ${s - 4.5}l4.5 4.5l-4.5 4.5l-4.5 -4.5z` }),
      make('text', { x: middle, y: height - 6, 'text-anchor': 'middle' }, String(i + 1)));
  });
}

function path(points) {
  return points.map(([x, y], i) => `${i ? 'L' : 'M'}${x.toFixed(1)} ${y.toFixed(1)}`).join('');
}

function drawPlot() {
  const { parts, light, paint, product } = examined;
  // What little light is left after some reflections is drawn larger, by a power of two.
  const magnified = 2 ** Math.max(0, Math.floor(Math.log2(0.9 / Math.max(1e-9, ...product))));
  $('magnified').textContent = magnified > 1 ? ` × ${magnified}, as are means` : '';
  const height = Math.round(Math.min(440, Math.max(260, $('plot').clientWidth * 0.54)));
  const left = 6, right = 8, top = 8, bottom = 46;
  const label = `Spectra of lamp, paint and reflected light over 380 to 780 nanometres, in ${parts.length} intervals`;
  const [svg, width] = chart($('plot'), height, label);
  const x = (nm) => left + (nm - 380) / 400 * (width - left - right);
  const y = (value) => top + (1 - Math.min(1.02, Math.max(0, value))) * (height - top - bottom);
  const stops = catalogue.hues.map((hue, i) => make('stop', { offset: i / 80, 'stop-color': rgb(hue) }));
  svg.append(make('defs', {}, make('linearGradient', { id: 'hues', gradientUnits: 'userSpaceOnUse', x1: x(380), x2: x(780), y1: 0, y2: 0 }, ...stops)));
  parts.forEach(({ from, to, share }, i) => {
    const span = { x: x(from), width: x(to) - x(from) };
    if (i % 2) svg.append(make('rect', { class: 'band', ...span, y: top, height: height - top - bottom }));
    svg.append(make('rect', { class: 'share', ...span, y: height - bottom + 3, height: 9, opacity: 0.04 + 0.8 * Math.min(1, share * 2) }),
      make('line', { class: 'edge', x1: x(to), x2: x(to), y1: top, y2: height - bottom + 12 }));
  });
  const curve = (values) => path(values.map((value, i) => [x(380 + i), y(value)]));
  const area = (values) => `${curve(values)}L${x(780)} ${y(0)}L${x(380)} ${y(0)}Z`;
  svg.append(
    make('path', { d: area(light), fill: 'url(#hues)', opacity: 0.3 }),
    make('path', { class: 'outline', d: curve(light) }),
    make('path', { d: area(product.map((value) => value * magnified)), fill: 'url(#hues)' }),
    make('path', { class: 'reflectance', d: curve(paint) }),
    make('path', { class: 'means', d: path(parts.flatMap(({ from, to, mean }) => [[x(from), y(mean * magnified)], [x(to), y(mean * magnified)]])) }),
    make('line', { class: 'axis', x1: left, x2: width - right, y1: y(0), y2: y(0) }));
  const every = width < 460 ? 100 : 50;
  for (let nm = 400; nm <= 750; nm += every) {
    svg.append(make('text', { x: x(nm), y: height - 14, 'text-anchor': 'middle' }, nm === 400 ? '400 nm' : String(nm)));
  }
}

/* ---- The light on a paint. ---- */

let examined = null;

function examine() {
  const threshold = $('threshold').valueAsNumber;
  if (!lamp || !(threshold > 0) || !$('threshold').checkValidity()) return;
  const paint = Number(document.querySelector('[name=paint]:checked').value);
  const found = ask('examine', threshold, Number($('mode').value), paint, Number($('reflections').value));
  if (found.error && typeof found.error === 'string') { refuse(found.error); return; }
  examined = found;
  $('paint-name').textContent = catalogue.paints[paint].name;
  const certain = $('mode').value === '0' ? 'Certainly within' : 'Thought to be within';
  $('verdict').replaceChildren(
    make('b', {}, number('intervals', found.intervals, String), found.intervals === 1 ? ' interval' : ' intervals'),
    `. ${certain} ΔE `, number('delta_e', found.delta_e, fixed(2)), ' of the true colour; in truth ',
    number('error', found.error, fixed(2)), ' off.', found.reached ? '' : ' That is all that the tables can tell.');
  drawPlot();
  operators();
  summary(paint);
}

function operators() {
  const eye = Number(document.querySelector('[name=eye]:checked').value);
  const truth = examined.operators[0];
  const tiles = examined.operators.map((way) => {
    const tile = make('div', { class: way.shown ? 'tile' : 'tile none', 'aria-hidden': 'true' });
    if (way.shown) {
      tile.style.background = rgb(way.shown[eye]);
      const disk = make('i');
      disk.style.background = rgb(truth.shown[eye]);
      if (way !== truth) tile.append(disk);
    }
    const words = way === truth
      ? make('p', {}, 'by all wavelengths')
      : make('p', {}, ...(way.shown ? ['ΔE', make('sub', {}, '00'), ' ', make('b', {}, number(`delta_e_00_${way.key}`, way.delta_e_00, fixed(2)))] : [way.note]));
    return make('li', { 'data-way': way.key }, tile, make('h3', {}, way.name), words);
  });
  $('operators').replaceChildren(...tiles);
}

function summary(paint) {
  const r = lamp.report;
  const rendered = r.ra === null ? 'no colour rendering index' : `R a ${fixed(1)(r.ra)}`;
  say(`${r.light}: ${kelvin(r.cct)}, ${rendered}. On ${catalogue.paints[paint].name}: ${examined.intervals} intervals, within ${fixed(2)(examined.delta_e)}.`);
}

/* ---- What people do. ---- */

/** Says what was wrong with what; the lamp before stays. */
function refuse(words, hint) {
  $('problem').replaceChildren(...(words ? [make('b', {}, words), make('span', {}, hint || '')] : []));
}

async function read(file) {
  if (!file) return;
  const most = 16;
  if (file.size > most * 2 ** 20) { refuse(`${file.name} is larger than ${most} MB: that is no spectrum.`); return; }
  let content;
  try {
    content = new Uint8Array(await file.arrayBuffer());
  } catch (error) {
    refuse(`${file.name} can’t be read: ${error.message}`);
    return;
  }
  const found = askOfFile(file.name, content);
  if (found.error) {
    const place = found.line ? `${file.name}, line ${found.line}` : file.name;
    refuse(`${place}: ${found.error}.`, lamp ? `Below is still ${lamp.report.light}.` : '');
    return;
  }
  $('builtin').selectedIndex = -1;
  show(found);
}

function controls() {
  $('builtin').append(...catalogue.lights.map((name, i) => make('option', { value: i }, name)));
  $('builtin').value = catalogue.lights.indexOf('FL11');
  $('paints').append(...catalogue.paints.map(({ name, srgb }, i) => {
    const paint = make('input', { type: 'radio', name: 'paint', value: i, 'aria-label': name, title: name });
    paint.style.setProperty('--paint', rgb(srgb));
    paint.checked = name === 'orange yellow';
    return paint;
  }));
  const hues = catalogue.hues.map(rgb).join(', ');
  document.documentElement.style.setProperty('--hues', `linear-gradient(to right, ${hues})`);
  $('rainbow').style.background = 'var(--hues)';
  $('threshold').value = 1;
  $('slider').value = 0;
  describeSlider();
}

function describeSlider() {
  $('slider').setAttribute('aria-valuetext', `ΔE ${$('threshold').value}`);
}

function listen() {
  $('builtin').addEventListener('change', (event) => show(ask('choose', Number(event.target.value))));
  $('file').addEventListener('change', (event) => {
    read(event.target.files[0]);
    event.target.value = '';
  });
  for (const id of ['reflections', 'mode', 'paints']) $(id).addEventListener('change', examine);
  document.querySelector('.eye').addEventListener('change', operators);
  $('slider').addEventListener('input', () => {
    $('threshold').value = Number((10 ** $('slider').valueAsNumber).toPrecision(2));
    describeSlider();
    examine();
  });
  $('threshold').addEventListener('input', () => {
    const value = $('threshold').valueAsNumber;
    if (value > 0) $('slider').value = Math.log10(value);
    describeSlider();
    examine();
  });
  window.addEventListener('dragover', (event) => { event.preventDefault(); $('drop').classList.add('over'); });
  window.addEventListener('dragleave', (event) => { if (!event.relatedTarget) $('drop').classList.remove('over'); });
  window.addEventListener('drop', (event) => {
    event.preventDefault();
    $('drop').classList.remove('over');
    read(event.dataTransfer.files[0]);
  });
  let width = window.innerWidth;
  window.addEventListener('resize', () => {
    if (window.innerWidth === width || !examined) return;
    width = window.innerWidth;
    drawBars();
    drawPlot();
  });
}

start().then(() => {
  controls();
  listen();
  show(ask('choose', Number($('builtin').value)));
}, (error) => refuse('This browser can’t run the page’s WebAssembly.', error.message));
