// The viewer of a report. It shows images of the same size that are panned and zoomed together and
// switched by keys, with exposure, errors in false colours, and the values under the cursor.
// html_viewer.c writes the description of the viewer and the images, each as several PNG files of
// one byte plane, so that the page has floats or halves of the full range. viewer_figures.js makes
// figures of the images.
'use strict';

// --- numbers -------------------------------------------------------------------------------------

// The values of all halves (IEEE 754 binary16).
const HALVES = (() => {
  const out = new Float32Array(65536);
  for (let bits = 0; bits < 65536; bits++) {
    const exponent = bits >> 10 & 31, fraction = bits & 1023, sign = bits >> 15 ? -1 : 1;
    out[bits] = sign * (exponent === 31 ? fraction ? NaN : Infinity
      : exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction);
  }
  return out;
})();
const HALF_MAX = 65504;

// Tone curves, from linear radiance to display values: those curves of src/image/tone.c that treat
// each channel separately.
const TONES = {
  none: x => x,
  aces: x => x * (2.51 * x + .03) / (x * (2.43 * x + .59) + .14), // Narkowicz 2015
};

// Returns the sRGB code of a linear value (IEC 61966-2-1), rounded to 8 bits.
function srgbCode(linear) {
  const x = Math.min(Math.max(linear, 0), 1);
  return Math.floor(255 * (x <= .0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - .055) + .5);
}

function formatValue(value, digits) {
  if (Number.isNaN(value)) return 'NaN';
  if (!Number.isFinite(value)) return value > 0 ? '\u221e' : '\u2212\u221e';
  if (digits < 9) return Math.abs(value) === HALF_MAX ? `beyond ${value}` : String(Number(value.toPrecision(digits)));
  // Uses the least number of digits that distinguishes this float from all others.
  for (let count = 6; ; count++) {
    const short = Number(value.toPrecision(count));
    if (count === 9 || Math.fround(short) === Math.fround(value)) return String(short);
  }
}

// --- images --------------------------------------------------------------------------------------

// Computes the 32-bit FNV-1a hash of the codes without alpha, as html_viewer.c does.
function hashCodes(rgba) {
  let hash = 0x811c9dc5;
  for (let i = 0; i < rgba.length; i += 4) {
    hash = Math.imul(hash ^ rgba[i], 0x01000193);
    hash = Math.imul(hash ^ rgba[i + 1], 0x01000193);
    hash = Math.imul(hash ^ rgba[i + 2], 0x01000193);
  }
  return hash >>> 0;
}

// Decodes the output of html_base91(), in which two characters represent 13 bits. Padding may add a
// zero byte at the end, which PNG readers ignore.
function decodeBase91(text) {
  const bytes = new Uint8Array(Math.floor(text.length / 2 * 13 / 8));
  const digit = i => {
    const code = text.charCodeAt(i);
    return (code === 126 ? 60 : code) - 35;
  };
  let bits = 0, bitCount = 0, to = 0;
  for (let i = 0; i < text.length; i += 2) {
    bits |= digit(i) + 91 * digit(i + 1) << bitCount;
    for (bitCount += 13; bitCount >= 8; bitCount -= 8, bits >>>= 8) bytes[to++] = bits & 255;
  }
  return bytes;
}

// Decodes a PNG that the page contains in base 91 to pixels, and removes it from the page.
async function decodePlane(id, sum) {
  const element = document.getElementById(id);
  const image = new Image();
  const url = URL.createObjectURL(new Blob([decodeBase91(element.textContent)], { type: 'image/png' }));
  element.remove();
  image.src = url;
  await image.decode();
  URL.revokeObjectURL(url);
  const canvas = document.createElement('canvas');
  canvas.width = image.naturalWidth;
  canvas.height = image.naturalHeight;
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  const rgba = context.getImageData(0, 0, canvas.width, canvas.height).data;
  return { rgba, isExact: hashCodes(rgba) === sum };
}

class Picture {
  constructor(viewer, entry, index) {
    Object.assign(this, { viewer, entry, index, label: entry.label, isReference: entry.reference });
    this.canvases = {}; // painted canvases by kind: { key, canvas }
    this.errors = {}; // values of error maps, by name
  }

  async load() {
    const { number, spec } = this.viewer;
    const plane = async name => {
      const { rgba, isExact } = await decodePlane(`pixels-${number}-${this.index}-${name}`, this.entry.sums[name]);
      if (!isExact) this.viewer.isAltered = true;
      return rgba;
    };
    const count = 3 * spec.width * spec.height, size = spec.bits / 8;
    const bytes = new Uint8Array(count * size);
    for (let byte = 0; byte < size; byte++) {
      const rgba = await plane(byte);
      for (let from = 0, to = byte; from < rgba.length; from += 4, to += 3 * size) {
        bytes[to] = rgba[from];
        bytes[to + size] = rgba[from + 1];
        bytes[to + 2 * size] = rgba[from + 2];
      }
    }
    this.halves = size === 2 ? new Uint16Array(bytes.buffer) : null;
    this.floats = size === 4 ? new Float32Array(bytes.buffer) : null;
    this.words = size === 4 ? new Uint32Array(bytes.buffer) : null;
    this.flip = 'flip' in this.entry.sums ? await plane('flip') : null;
  }

  value(component) {
    return this.floats ? this.floats[component] : HALVES[this.halves[component]];
  }

  // Returns the index of a component in the table of codes: the half itself, or the upper 17 bits
  // of a float. The lower bits change the code by at most about a fifth.
  code(component) {
    return this.words ? this.words[component] >>> 15 : this.halves[component];
  }

  // Returns the values of an error map for all pixels; NaN if an image is not finite there.
  errorsOf(map) {
    if (this.errors[map]) return this.errors[map];
    const { spec, reference } = this.viewer, count = spec.width * spec.height;
    const isFlip = map === 'flip' || map === 'hdr-flip', at = map === 'flip' ? 0 : 1;
    const out = new Float32Array(count);
    for (let pixel = 0; pixel < count; pixel++) {
      let sum = 0;
      for (let k = 3 * pixel; k < 3 * pixel + 3; k++) {
        const x = this.value(k), r = reference.value(k), d = Math.abs(x - r);
        if (map === 'squared') sum += d * d / (r * r + spec.epsilon);
        else if (map === 'smape') sum += 2 * d / (Math.abs(x) + Math.abs(r) + spec.smapeEpsilon);
        else sum += d / (Math.abs(r) + spec.epsilon);
      }
      out[pixel] = !Number.isFinite(sum) ? NaN : isFlip ? this.flip[4 * pixel + at] / 255 : sum / 3;
    }
    this.errors[map] = out;
    return out;
  }

  paintLight(data) {
    const codes = this.viewer.displayCodes();
    for (let i = 0, k = 0; i < data.length; i += 4) {
      data[i] = codes[this.code(k++)];
      data[i + 1] = codes[this.code(k++)];
      data[i + 2] = codes[this.code(k++)];
      data[i + 3] = 255;
    }
  }

  paintErrors(data, map) {
    const { palette } = this.viewer.spec, errors = this.errorsOf(map.name), last = palette.length - 1;
    const colors = Uint8Array.from([].concat(...palette));
    for (let pixel = 0, i = 0; pixel < errors.length; pixel++, i += 4) {
      const level = errorLevel(map, errors[pixel]);
      const color = 3 * Math.floor(level * last + .5), isKnown = color >= 0; // false for NaN
      data[i] = isKnown ? colors[color] : 0;
      data[i + 1] = isKnown ? colors[color + 1] : 255;
      data[i + 2] = isKnown ? colors[color + 2] : 0;
      data[i + 3] = 255;
    }
  }

  // Returns a canvas with the image or, if a map is named, with its errors.
  painted(mode) {
    const { spec, exposure, tone } = this.viewer;
    const map = this.isReference ? null : spec.maps.find(m => m.name === mode);
    const kind = map ? map.name : 'light', key = map ? '' : `${exposure} ${tone}`;
    const known = this.canvases[kind];
    if (known && known.key === key) return known.canvas;
    const canvas = known ? known.canvas : document.createElement('canvas');
    canvas.width = spec.width;
    canvas.height = spec.height;
    const context = canvas.getContext('2d'), data = context.createImageData(spec.width, spec.height);
    if (map) this.paintErrors(data.data, map);
    else this.paintLight(data.data);
    context.putImageData(data, 0, 0);
    this.canvases[kind] = { key, canvas };
    return canvas;
  }
}

// Returns the position of a value on the map's colour scale, in [0, 1]; NaN for NaN.
function errorLevel(map, value) {
  const level = map.log ? Math.log(value / map.low) / Math.log(map.high / map.low)
    : (value - map.low) / (map.high - map.low);
  return Math.min(Math.max(level, 0), 1);
}

// --- the viewer ----------------------------------------------------------------------------------

const SCALE_MIN = 1 / 16, SCALE_MAX = 128;
const CROPS_MAX = 6;

// Makes an element with properties and children.
function make(name, properties, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties || {})) {
    if (key in element && key !== 'list') element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

class Viewer {
  constructor(root) {
    this.root = root;
    this.number = Number(root.id.replace('viewer-', ''));
    this.spec = JSON.parse(root.querySelector('script.spec').textContent);
    this.pictures = this.spec.pictures.map((entry, i) => new Picture(this, entry, i));
    this.reference = this.pictures.find(p => p.isReference) || null;
    this.hasFlip = this.spec.pictures.some(entry => 'flip' in entry.sums);
    this.current = 0;
    this.mode = 'light';
    this.exposure = Number(this.spec.exposure.toPrecision(4)); // a float, rounded to few digits
    this.tone = this.spec.tone;
    this.isSplit = false;
    this.isCropping = false;
    this.isAltered = false;
    this.cursor = null; // the pixel whose values are shown
    this.crops = [];    // { x, y, width, height } in pixels
    this.isFitted = true;
    this.pointers = new Map();
  }

  async begin() {
    for (const picture of this.pictures) await picture.load();
    this.build();
    if (this.reference) this.chooseCrops();
    this.resize();
    new ResizeObserver(() => this.resize()).observe(this.stage);
    this.updateAll();
    this.root.dataset.ready = 'true';
  }

  // Computes the codes of all halves, or of all upper parts of floats, for the current exposure.
  displayCodes() {
    const key = `${this.exposure} ${this.tone}`;
    if (this.codesKey === key) return this.codes;
    const isHalf = this.spec.bits === 16, count = isHalf ? 65536 : 131072;
    const gain = 2 ** this.exposure, curve = TONES[this.tone];
    const word = new Uint32Array(1), float = new Float32Array(word.buffer);
    const codes = new Uint8Array(count);
    for (let i = 0; i < count; i++) {
      word[0] = (i << 15 | 1 << 14) >>> 0; // the centre of all floats with these upper bits
      const value = isHalf ? HALVES[i] : float[0];
      const light = value > 0 ? Math.min(value * gain, 1e30) : 0; // NaN becomes black
      codes[i] = srgbCode(curve(light));
    }
    this.codesKey = key;
    this.codes = codes;
    return codes;
  }

  // --- controls ----------------------------------------------------------------------------------

  build() {
    const { spec } = this;
    this.tabs = this.pictures.map((picture, i) => {
      const tab = figures.button('', `${picture.entry.title}${i < 9 ? ` (key ${i + 1})` : ''}`, () => this.show(i));
      tab.append(make('kbd', {}, i < 9 ? String(i + 1) : ''), picture.label);
      return tab;
    });
    this.canvas = make('canvas', { tabIndex: 0, role: 'img', 'aria-label': 'the picture; arrow keys move the pixel whose values are shown' });
    this.name = make('div', { className: 'viewer-name' });
    this.stage = make('div', { className: 'viewer-stage' }, this.canvas, this.name);
    this.divider = make('input', { type: 'range', className: 'viewer-divider', min: 0, max: 1, step: .001, value: .5, hidden: true,
      'aria-label': 'where the reference begins', oninput: () => this.draw() });
    this.notes = make('div');
    if (spec.reduction > 1)
      this.notes.append(make('p', { className: 'note' }, `Pictures of ${spec.sourceWidth} \u00d7 ${spec.sourceHeight} pixels ` +
        `are reduced here: each pixel is the mean of ${spec.reduction} \u00d7 ${spec.reduction}. Errors in tables are computed from the original pictures.`));
    if (spec.digits === 3)
      this.notes.append(make('p', { className: 'viewer-help' }, 'The pictures are large, so the page has only three digits of each value.'));
    if (this.isAltered)
      this.notes.append(make('p', { className: 'note' }, 'This browser alters what is read from canvases (a protection against ' +
        'fingerprinting): pixels and values here are not those of the files.'));
    this.root.append(this.notes, make('div', { className: 'viewer-tabs', role: 'group', 'aria-label': 'which picture' }, ...this.tabs),
      this.buildTools(), this.stage, this.divider, this.buildHelp(), this.buildUnder());
    this.figures = new ViewerFigures(this);
    this.root.append(this.figures.element);
    this.listen();
  }

  buildTools() {
    const { spec } = this;
    const option = (value, text) => make('option', { value }, text);
    this.modeBox = make('select', { onchange: () => this.setMode(this.modeBox.value) }, option('light', 'the picture'));
    for (const map of this.reference ? spec.maps : [])
      if (this.hasFlip || !map.name.includes('flip')) this.modeBox.append(option(map.name, `error, ${map.words}`));
    this.scaleBar = make('span', { className: 'viewer-scale', hidden: true });
    this.exposureBar = make('input', { type: 'range', min: -10, max: 10, step: .25, oninput: () => this.setExposure(Number(this.exposureBar.value)),
      'aria-label': 'exposure in stops' });
    this.exposureBox = make('input', { type: 'number', step: .25, onchange: () => this.setExposure(Number(this.exposureBox.value) || 0),
      'aria-label': 'exposure in stops' });
    this.toneBox = make('select', { onchange: () => this.setTone(this.toneBox.value) }, option('none', 'sRGB'), option('aces', 'ACES'));
    this.zoomText = make('output');
    this.splitButton = figures.button('Split', 'Show the reference to the right of a divider (S)', () => this.setSplit(!this.isSplit));
    this.splitButton.disabled = !this.reference;
    this.cropButton = figures.button('Crop', 'Drag a rectangle; it is the same in all pictures (C, or drag with Shift)', () => this.setCropping(!this.isCropping));
    return make('div', { className: 'viewer-tools' },
      make('label', {}, 'Show', this.modeBox), this.scaleBar,
      make('span', {}, 'Exposure', this.exposureBar, this.exposureBox, 'stops'),
      make('label', {}, 'Tone', this.toneBox),
      make('span', { className: 'group' }, figures.button('\u2212', 'Smaller (\u2212)', () => this.zoom(.5)),
        figures.button('+', 'Larger (+)', () => this.zoom(2)), figures.button('1:1', 'One screen pixel for each pixel (0)', () => this.setScale(1)),
        figures.button('Fit', 'Show the whole picture (F)', () => this.fit()), this.zoomText),
      make('span', { className: 'group' }, this.splitButton, this.cropButton));
  }

  buildHelp() {
    const keys = [['1\u20139', 'show a picture'], ['M', 'next error map'], ['E, Shift+E', 'brighter, darker'], ['+, \u2212, 0, F', 'zoom; 1:1; fit'],
      ['S', 'split with the reference'], ['C', 'crop; Enter adds a crop at the pixel, or in the middle'], ['arrows', 'move the pixel; with Shift the picture'],
      ['drag, wheel', 'pan; zoom, after a click on the picture or with Ctrl']];
    const list = keys.flatMap(([key, words], i) => [i ? ' \u00b7 ' : '', make('kbd', {}, make('b', {}, key)), ` ${words}`]);
    return make('details', { className: 'viewer-help' }, make('summary', {}, 'Keys and mouse'), make('p', {}, ...list));
  }

  buildUnder() {
    this.values = make('table', { className: 'viewer-values' });
    this.valuesHead = make('h3');
    this.cropList = make('table', { className: 'viewer-crops' });
    this.cropHead = make('h3', {}, 'Crops');
    return make('div', { className: 'viewer-under' },
      make('div', {}, this.valuesHead, make('div', { className: 'wide' }, this.values)),
      make('div', {}, this.cropHead, make('div', { className: 'wide' }, this.cropList)));
  }

  listen() {
    const { canvas } = this;
    canvas.addEventListener('pointerdown', event => this.pointerDown(event));
    canvas.addEventListener('pointermove', event => this.pointerMove(event));
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, event => this.pointerUp(event));
    canvas.addEventListener('dblclick', () => this.fit());
    canvas.addEventListener('wheel', event => {
      if (document.activeElement !== canvas && !event.ctrlKey) return; // then the page scrolls
      event.preventDefault();
      this.zoom(2 ** (-event.deltaY / (event.ctrlKey ? 100 : 300)), this.placeOf(event));
    }, { passive: false });
  }

  // --- drawing -----------------------------------------------------------------------------------

  show(index) {
    if (!this.pictures[index]) return;
    this.current = index;
    this.update();
  }

  setMode(mode) {
    this.mode = mode;
    this.updateAll();
  }

  setExposure(stops) {
    this.exposure = Number(Math.min(Math.max(stops, -30), 30).toPrecision(4));
    this.updateAll();
  }

  setTone(tone) {
    this.tone = tone;
    this.updateAll();
  }

  setSplit(isSplit) {
    this.isSplit = isSplit && this.reference !== null;
    this.update();
  }

  setCropping(isCropping) {
    this.isCropping = isCropping;
    this.update();
  }

  // Updates the controls and the image.
  update() {
    const picture = this.pictures[this.current], map = this.spec.maps.find(m => m.name === this.mode);
    this.tabs.forEach((tab, i) => tab.setAttribute('aria-pressed', i === this.current));
    this.modeBox.value = this.mode;
    this.exposureBar.value = this.exposure;
    this.exposureBox.value = this.exposure;
    this.toneBox.value = this.tone;
    this.splitButton.setAttribute('aria-pressed', this.isSplit);
    this.cropButton.setAttribute('aria-pressed', this.isCropping);
    this.divider.hidden = !this.isSplit;
    this.scaleBar.hidden = !map;
    if (map) this.buildScale(map);
    this.name.textContent = picture.label + (map && !picture.isReference ? `, ${map.words}` : '') +
      (this.isSplit ? ` | ${this.reference.label}` : '');
    this.updateValues();
    this.draw();
  }

  updateAll() {
    this.update();
    this.updateCrops();
    this.figures.changed();
  }

  buildScale(map) {
    const bar = make('canvas', { width: this.spec.palette.length, height: 1 }), context = bar.getContext('2d');
    this.spec.palette.forEach((color, i) => { context.fillStyle = `rgb(${color})`; context.fillRect(i, 0, 1, 1); });
    this.scaleBar.replaceChildren(map.low.toString().replace('1e-', '1e\u2212'), bar, String(map.high));
  }

  updateValues() {
    const { cursor, spec } = this, map = this.spec.maps.find(m => m.name === this.mode) || spec.maps[0];
    const head = ['', 'red', 'green', 'blue'].concat(this.reference ? [map.name] : []);
    this.valuesHead.textContent = cursor ? `Pixel ${cursor.x}, ${cursor.y}` : 'Pixel values';
    this.valuesHead.title = spec.digits < 9 ? `The page has ${spec.digits} digits of each value.` : 'The page has all digits of each value.';
    const rows = this.pictures.map((picture, i) => {
      const row = make('tr', { className: i === this.current ? 'shown' : '' });
      const swatch = make('span', { className: 'viewer-swatch' });
      row.append(make('th', {}, swatch, picture.label));
      const pixel = cursor ? cursor.y * spec.width + cursor.x : -1;
      for (let k = 0; k < 3; k++)
        row.append(make('td', { className: 'number' }, cursor ? formatValue(picture.value(3 * pixel + k), spec.digits) : '\u2013'));
      if (this.reference)
        row.append(make('td', { className: 'number' }, !cursor || picture.isReference ? '\u2013' : this.errorText(picture, map, pixel)));
      if (cursor) swatch.style.background = `rgb(${[0, 1, 2].map(k => this.displayCodes()[picture.code(3 * pixel + k)])})`;
      return row;
    });
    this.values.replaceChildren(make('tr', {}, ...head.map(text => make('th', {}, text))), ...rows);
  }

  errorText(picture, map, pixel) {
    const value = picture.errorsOf(map.name)[pixel];
    return map.name.includes('flip') ? value.toFixed(this.spec.bits === 16 ? 2 : 3) : formatValue(Number(value.toPrecision(4)), 9);
  }

  // --- geometry ----------------------------------------------------------------------------------

  resize() {
    const width = this.stage.clientWidth, { spec } = this, most = Math.max(320, window.innerHeight * .72);
    const height = Math.max(Math.round(spec.height * this.fittingScale(width, most)), 240);
    const ratio = window.devicePixelRatio || 1;
    if (this.cssWidth === width && this.cssHeight === height && this.ratio === ratio) return;
    Object.assign(this, { cssWidth: width, cssHeight: height, ratio });
    this.canvas.style.height = `${height}px`;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    if (this.isFitted) this.fit();
    else this.draw();
  }

  // Returns the scale at which the whole image fits. For small images it is a whole number, so that
  // all pixels have the same size.
  fittingScale(width, height) {
    const scale = Math.min(width / this.spec.width, height / this.spec.height);
    return scale > 1 ? Math.floor(scale) : scale;
  }

  fit() {
    this.scale = this.fittingScale(this.cssWidth, this.cssHeight);
    this.centre = { x: this.spec.width / 2, y: this.spec.height / 2 };
    this.isFitted = true;
    this.draw();
  }

  setScale(scale, anchor) {
    const fixed = anchor || this.centre, old = this.scale;
    this.scale = Math.min(Math.max(scale, SCALE_MIN), SCALE_MAX);
    // The fixed point keeps its place on the canvas.
    this.moveTo(fixed.x + (this.centre.x - fixed.x) * old / this.scale, fixed.y + (this.centre.y - fixed.y) * old / this.scale);
  }

  zoom(factor, anchor) {
    this.setScale(this.scale * factor, anchor);
  }

  moveTo(x, y) {
    this.centre = { x: Math.min(Math.max(x, 0), this.spec.width), y: Math.min(Math.max(y, 0), this.spec.height) };
    this.isFitted = false;
    this.draw();
  }

  // Returns the position of the image's upper left corner on the canvas, in CSS pixels.
  corner() {
    return { x: this.cssWidth / 2 - this.centre.x * this.scale, y: this.cssHeight / 2 - this.centre.y * this.scale };
  }

  // Returns the position of an event in the image, in pixels.
  placeOf(event) {
    const box = this.canvas.getBoundingClientRect(), corner = this.corner();
    return { x: (event.clientX - box.left - corner.x) / this.scale, y: (event.clientY - box.top - corner.y) / this.scale };
  }

  draw() {
    if (this.isDrawing || this.scale === undefined) return;
    this.isDrawing = true;
    requestAnimationFrame(() => { this.isDrawing = false; this.drawNow(); });
  }

  drawNow() {
    const context = this.canvas.getContext('2d'), { scale, ratio, spec } = this, corner = this.corner();
    this.zoomText.value = scale >= 1 ? `${Number(scale.toPrecision(3))}\u00d7` : `${Math.round(scale * 100)} %`;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.setTransform(ratio, 0, 0, ratio, corner.x * ratio, corner.y * ratio);
    context.imageSmoothingEnabled = scale * ratio < 1;
    context.imageSmoothingQuality = 'high';
    const place = [0, 0, spec.width * scale, spec.height * scale];
    context.drawImage(this.pictures[this.current].painted(this.mode), ...place);
    if (this.isSplit) {
      const x = this.divider.value * this.cssWidth - corner.x;
      context.save();
      context.beginPath();
      context.rect(x, -corner.y, this.cssWidth, this.cssHeight);
      context.clip();
      context.fillStyle = '#0c0e10';
      context.fillRect(...place);
      context.drawImage(this.reference.painted('light'), ...place);
      context.restore();
      context.fillStyle = '#fff';
      context.fillRect(x - 1, -corner.y, 2, this.cssHeight);
    }
    this.crops.forEach((crop, i) => this.drawRectangle(context, crop, figures.COLORS[i % figures.COLORS.length], 2.5));
    if (this.drawn) this.drawRectangle(context, this.drawn, '#ffffff', 1.5);
    if (this.cursor && scale >= 6) this.drawRectangle(context, Object.assign({ width: 1, height: 1 }, this.cursor), '#ffffff', 1);
  }

  // Draws wider white lines first, so that the rectangle is visible on every image.
  drawRectangle(context, r, color, width) {
    const s = this.scale;
    for (const [style, line] of [['rgba(255,255,255,.85)', width + 1.5], [color, width]]) {
      context.strokeStyle = style;
      context.lineWidth = line;
      context.strokeRect(r.x * s, r.y * s, r.width * s, r.height * s);
    }
  }

  // --- pointer and keys --------------------------------------------------------------------------

  pointerDown(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const isCrop = (this.isCropping || event.shiftKey) && this.pointers.size === 1;
    this.dragged = isCrop ? { from: this.placeOf(event) } : null;
    this.canvas.classList.toggle('moving', !isCrop);
  }

  pointerMove(event) {
    const before = this.pointers.get(event.pointerId), place = this.placeOf(event);
    const x = Math.floor(place.x), y = Math.floor(place.y);
    if (x >= 0 && y >= 0 && x < this.spec.width && y < this.spec.height) this.setCursor(x, y);
    if (!before) return;
    const now = { x: event.clientX, y: event.clientY };
    if (this.dragged) {
      this.drawn = this.rectangle(this.dragged.from, place);
      this.draw();
    } else if (this.pointers.size === 1) {
      this.moveTo(this.centre.x - (now.x - before.x) / this.scale, this.centre.y - (now.y - before.y) / this.scale);
    } else { // two fingers
      const other = Array.from(this.pointers).find(([id]) => id !== event.pointerId)[1];
      const distance = p => Math.hypot(p.x - other.x, p.y - other.y);
      if (distance(before) > 0) this.zoom(distance(now) / distance(before), place);
    }
    this.pointers.set(event.pointerId, now);
  }

  pointerUp(event) {
    this.pointers.delete(event.pointerId);
    this.canvas.classList.remove('moving');
    if (this.drawn && this.drawn.width > 1 && this.drawn.height > 1) this.addCrop(this.drawn);
    this.dragged = this.drawn = null;
    this.draw();
  }

  setCursor(x, y) {
    if (this.cursor && this.cursor.x === x && this.cursor.y === y) return;
    this.cursor = { x, y };
    this.updateValues();
    this.draw();
  }

  moveCursor(dx, dy) {
    const at = this.cursor || { x: Math.floor(this.centre.x), y: Math.floor(this.centre.y) };
    this.setCursor(Math.min(Math.max(at.x + dx, 0), this.spec.width - 1), Math.min(Math.max(at.y + dy, 0), this.spec.height - 1));
  }

  // Handles a key. Returns whether the key has a function.
  key(event) {
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (arrow) {
      if (document.activeElement !== this.canvas) return false; // then the page scrolls
      const step = 48 / this.scale;
      if (event.shiftKey) this.moveTo(this.centre.x + arrow[0] * step, this.centre.y + arrow[1] * step);
      else this.moveCursor(...arrow);
      return true;
    }
    const modes = Array.from(this.modeBox.options, o => o.value);
    const actions = {
      m: () => this.setMode(modes[(modes.indexOf(this.mode) + 1) % modes.length]),
      e: () => this.setExposure(this.exposure + .5),
      E: () => this.setExposure(this.exposure - .5),
      '+': () => this.zoom(2), '=': () => this.zoom(2), '-': () => this.zoom(.5), 0: () => this.setScale(1), f: () => this.fit(),
      s: () => this.setSplit(!this.isSplit),
      c: () => this.setCropping(!this.isCropping),
      Escape: () => this.setCropping(false),
    };
    if (event.key >= '1' && event.key <= '9') this.show(Number(event.key) - 1);
    else if (event.key === 'Enter' && this.isCropping && document.activeElement === this.canvas) this.cropHere();
    else if (actions[event.key]) actions[event.key]();
    else return false;
    return true;
  }

  // --- crops -------------------------------------------------------------------------------------

  // Rounds a rectangle to whole pixels inside of the image.
  rectangle(a, b) {
    const limit = (value, most) => Math.min(Math.max(Math.round(value), 0), most);
    const x = [a.x, b.x].map(v => limit(v, this.spec.width)), y = [a.y, b.y].map(v => limit(v, this.spec.height));
    return { x: Math.min(...x), y: Math.min(...y), width: Math.abs(x[1] - x[0]), height: Math.abs(y[1] - y[0]) };
  }

  addCrop(crop) {
    this.areCropsChosen = true;
    this.crops.push(crop);
    if (this.crops.length > CROPS_MAX) this.crops.shift();
    this.updateAll();
  }

  // Adds a square crop with an eighth of the image's width. Its centre is the pixel whose values
  // are shown or, if there is none, the centre of the visible part.
  cropHere() {
    const size = Math.max(Math.round(this.spec.width / 8), 2), at = this.cursor || this.centre;
    this.addCrop(this.rectangle({ x: at.x - size / 2, y: at.y - size / 2 }, { x: at.x + size / 2, y: at.y + size / 2 }));
  }

  // Chooses the initial crops: two separate places at which the relative errors of the images are
  // greatest.
  chooseCrops() {
    const { width, height } = this.spec, size = Math.max(Math.round(Math.min(width, height) / 5), 2);
    const columns = Math.floor(width / size), rows = Math.floor(height / size);
    const maps = this.pictures.filter(p => !p.isReference).map(p => p.errorsOf('relative')), blocks = [];
    for (let j = 0; j < rows; j++)
      for (let i = 0; i < columns; i++) {
        let sum = 0;
        for (let y = j * size; y < (j + 1) * size; y++)
          for (let x = i * size; x < (i + 1) * size; x++)
            for (const errors of maps) sum += Math.min(errors[y * width + x] || 0, 1);
        blocks.push({ x: i * size, y: j * size, width: size, height: size, sum });
      }
    blocks.sort((a, b) => b.sum - a.sum);
    const first = blocks[0];
    const second = blocks.find(b => first && Math.abs(b.x - first.x) + Math.abs(b.y - first.y) > 2 * size);
    this.crops = [first, second].filter(Boolean).map(({ x, y, width: w, height: h }) => ({ x, y, width: w, height: h }));
  }

  updateCrops() {
    this.cropHead.textContent = this.areCropsChosen || !this.crops.length ? 'Crops' : 'Crops, where errors are greatest';
    const rows = this.crops.map((crop, i) => {
      const box = key => make('td', {}, make('input', { type: 'number', min: 0, value: crop[key], 'aria-label': `${key} of crop ${i + 1}`,
        onchange: event => {
          const changed = Object.assign({}, crop, { [key]: Math.round(Number(event.target.value)) || 0 });
          this.crops[i] = this.rectangle(changed, { x: changed.x + Math.max(changed.width, 1), y: changed.y + Math.max(changed.height, 1) });
          this.areCropsChosen = true;
          this.updateAll();
        } }));
      const swatch = make('span', { className: 'viewer-swatch' });
      swatch.style.background = figures.COLORS[i % figures.COLORS.length];
      return make('tr', {}, make('th', {}, swatch, String(i + 1)), box('x'), box('y'), box('width'), box('height'),
        make('td', {}, figures.button('\u00d7', 'Remove this crop', () => { this.crops.splice(i, 1); this.areCropsChosen = true; this.updateAll(); })));
    });
    const head = ['', 'x', 'y', 'width', 'height', ''].map(text => make('th', {}, text));
    this.cropList.replaceChildren(make('tr', {}, ...head), ...rows);
    if (!rows.length)
      this.cropList.replaceChildren(make('tr', {}, make('th', {}, 'There are none: press Crop and drag over the picture.')));
  }
}

// --- the page ------------------------------------------------------------------------------------

document.addEventListener('DOMContentLoaded', async () => {
  const viewers = Array.from(document.querySelectorAll('.viewer'), root => new Viewer(root));
  let last = viewers[0];
  document.addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches('input, select, textarea')) return;
    if (last && last.canvas && last.key(event)) event.preventDefault();
  });
  for (const viewer of viewers) {
    for (const name of ['pointerenter', 'focusin']) viewer.root.addEventListener(name, () => { last = viewer; });
    try {
      await viewer.begin();
    } catch (error) {
      viewer.root.prepend(make('p', { className: 'note' }, `The pictures cannot be shown: ${error.message}`));
      viewer.root.dataset.ready = 'failed';
    }
  }
});
