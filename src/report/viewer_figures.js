// Figures of a viewer's images: insets as in publications, and plots of errors. They use the
// viewer's crops, its exposure and the map that it shows.
'use strict';

// Formats a number, for example as "1.23e-4", with the Unicode minus sign.
function formatError(value) {
  if (!Number.isFinite(value)) return value > 0 ? '\u221e' : '\u2013';
  const text = value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5) ? value.toExponential(2) : value.toPrecision(3);
  return text.replace('e+', 'e').replace(/-/g, '\u2212');
}

// Returns the ticks of an axis: powers of ten if the range has at least two decades, otherwise 1, 2
// and 5 times powers of ten.
function logTicks(low, high) {
  const ticks = [], decades = Math.log10(high / low);
  for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); k++)
    for (const digit of decades >= 2 ? [1] : [1, 2, 5]) ticks.push(digit * 10 ** k);
  const step = decades > 8 ? 2 : 1; // with this step, labels do not touch
  return ticks.filter((v, i) => v >= low * .999 && v <= high * 1.001 && i % step === 0);
}

function evenTicks(low, high) {
  const rough = (high - low) / 5, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(f => f * power).find(f => f >= rough);
  const ticks = [];
  for (let i = Math.ceil(low / step); i * step <= high + step * 1e-9; i++) ticks.push(Number((i * step).toPrecision(12)));
  return ticks;
}

class Axis {
  // Maps [low, high] to [from, to], linearly or logarithmically.
  constructor(low, high, isLog, from, to) {
    Object.assign(this, { low, high, isLog, from, to });
  }

  at(value) {
    const level = this.isLog ? Math.log(value / this.low) / Math.log(this.high / this.low) : (value - this.low) / (this.high - this.low);
    return this.from + level * (this.to - this.from);
  }

  ticks() {
    const ticks = this.isLog ? logTicks(this.low, this.high) : [];
    // Over a short range a logarithmic axis is almost linear.
    return ticks.length > 1 ? ticks : evenTicks(this.low, this.high);
  }

  label(value) {
    if (!this.isLog) return String(value).replace('-', '\u2212');
    const power = Math.round(Math.log10(value));
    return Math.abs(power) > 2 ? `${Math.round(value / 10 ** Math.floor(Math.log10(value) + 1e-9))}e${Math.floor(Math.log10(value) + 1e-9)}`.replace('-', '\u2212') : String(Number(value.toPrecision(3)));
  }
}

class ViewerFigures {
  constructor(viewer) {
    this.viewer = viewer;
    this.element = make('div', { className: 'viewer-figures' });
    const name = viewer.number > 0 ? `-${viewer.number + 1}` : '';
    this.insets = this.add(`insets${name}`, 'insets');
    const names = new Set([].concat(...viewer.spec.pictures.map(p => p.figures.filter(f => f.low !== null && f.high !== null).map(f => f.name))));
    if (names.size) {
      this.metricBox = make('select', { onchange: () => this.build(), 'aria-label': 'which error' }, ...Array.from(names, n => make('option', { value: n }, n)));
      this.intervals = this.add(`errors${name}`, 'intervals', this.metricBox);
    }
    if (viewer.reference) this.distribution = this.add(`distribution${name}`, 'distribution');
  }

  add(name, kind, ...controls) {
    const paper = make('div', { className: 'paper' });
    const bar = figures.exportBar(name, () => paper.querySelector('svg'));
    bar.append(...controls);
    this.element.append(make('figure', { className: kind }, paper, bar));
    return paper;
  }

  // Updates the figure after a short delay, because a single figure is enough while a slider moves.
  changed() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.build(), 120);
  }

  async build() {
    const { viewer } = this;
    this.insets.closest('figure').hidden = !viewer.crops.length;
    if (viewer.crops.length) this.insets.replaceChildren(this.drawInsets());
    if (this.intervals) this.intervals.replaceChildren(this.drawIntervals());
    if (this.distribution) await this.buildDistribution();
    viewer.root.dataset.figures = String(Number(viewer.root.dataset.figures || 0) + 1);
  }

  // Processes the images one by one, so that keys are handled in between.
  async buildDistribution() {
    const { viewer } = this, mode = viewer.mode;
    const map = viewer.spec.maps.find(m => m.name === mode) || viewer.spec.maps[0];
    for (const picture of viewer.pictures) {
      if (!picture.isReference) this.shares(picture, map);
      await new Promise(done => setTimeout(done));
      if (viewer.mode !== mode) return; // another update has been started
    }
    this.distribution.replaceChildren(this.drawDistribution(map));
  }

  // Shortens a name to a width in pixels by removing its middle, because names differ more often at
  // their ends.
  static shorten(text, width, size, bold) {
    const context = ViewerFigures.context || (ViewerFigures.context = document.createElement('canvas').getContext('2d'));
    context.font = `${bold ? 'bold ' : ''}${size}px Helvetica, Arial, 'Liberation Sans', sans-serif`;
    if (context.measureText(text).width <= width) return text;
    let kept = Array.from(text);
    while (kept.length > 1 && context.measureText(`${kept.join('')}\u2026`).width > width) kept.splice(Math.floor(kept.length / 2), 1);
    const half = Math.floor(kept.length / 2);
    return `${kept.slice(0, half).join('')}\u2026${kept.slice(half).join('')}`;
  }

  // --- insets ------------------------------------------------------------------------------------

  // Returns a crop as a PNG in which each pixel is a square of several pixels, so that no reader
  // blurs it.
  cropUrl(picture, crop, width, mode) {
    const times = Math.max(1, Math.ceil(2 * width / crop.width));
    const canvas = make('canvas', { width: crop.width * times, height: crop.height * times });
    const context = canvas.getContext('2d');
    context.imageSmoothingEnabled = false;
    context.drawImage(picture.painted(mode), crop.x, crop.y, crop.width, crop.height, 0, 0, canvas.width, canvas.height);
    return canvas.toDataURL('image/png');
  }

  // Returns the least of the images' values of a metric, which is printed in bold. Returns NaN if
  // only one image has a value.
  best(name) {
    const values = this.viewer.spec.pictures.map(p => p.figures.find(f => f.name === name)).filter(f => f && f.value !== null);
    return values.length > 1 ? Math.min(...values.map(f => f.value)) : NaN;
  }

  drawInsets() {
    const { viewer } = this, { spec, crops, pictures } = viewer;
    const GAP = 6, HEAD = 22, FOOT = 34, LEFT = 250, WIDTH = 1000;
    const columns = pictures.length, cell = Math.min(150, Math.floor((WIDTH - LEFT - GAP * columns) / columns));
    const heights = crops.map(c => Math.round(cell * Math.min(c.height / c.width, 2)));
    const leftHeight = Math.round(LEFT * spec.height / spec.width);
    const height = HEAD + Math.max(heights.reduce((a, b) => a + b + GAP, 0) - GAP + FOOT, leftHeight + FOOT);
    const svg = figures.create(LEFT + columns * (cell + GAP), height);
    const base = viewer.reference || pictures[viewer.current];
    figures.draw(svg, 'text', { x: 0, y: 14, 'font-weight': 700 }, ViewerFigures.shorten(base.label, LEFT, 12, true));
    this.drawPicture(svg, base, { x: 0, y: 0, width: spec.width, height: spec.height }, [0, HEAD, LEFT, leftHeight], 'light');
    crops.forEach((crop, i) => figures.draw(svg, 'rect', { x: crop.x / spec.width * LEFT, y: HEAD + crop.y / spec.height * leftHeight,
      width: crop.width / spec.width * LEFT, height: crop.height / spec.height * leftHeight, fill: 'none', stroke: figures.COLORS[i], 'stroke-width': 2 }));
    const lines = [`exposure ${formatStops(viewer.exposure)}`];
    const map = spec.maps.find(m => m.name === viewer.mode);
    if (map) lines.push(map.words);
    lines.forEach((text, i) => figures.draw(svg, 'text', { x: 0, y: HEAD + leftHeight + 15 + 14 * i, 'font-size': 11, fill: '#586472' }, text));
    pictures.forEach((picture, i) => this.drawColumn(svg, picture, LEFT + GAP + i * (cell + GAP), cell, heights, HEAD, GAP));
    return svg;
  }

  drawColumn(svg, picture, x, cell, heights, top, gap) {
    const { crops, mode } = this.viewer;
    figures.draw(svg, 'text', { x: x + cell / 2, y: 14, 'text-anchor': 'middle', 'font-weight': 700 },
      ViewerFigures.shorten(picture.label, cell, 12, true));
    let y = top;
    crops.forEach((crop, i) => {
      this.drawPicture(svg, picture, crop, [x, y, cell, heights[i]], mode);
      figures.draw(svg, 'rect', { x: x + 1, y: y + 1, width: cell - 2, height: heights[i] - 2, fill: 'none', stroke: figures.COLORS[i], 'stroke-width': 2 });
      y += heights[i] + gap;
    });
    const figure = picture.entry.figures[0];
    const [name, value] = figure ? [figure.name, figure.value] : [picture.isReference ? 'reference' : '', null];
    figures.draw(svg, 'text', { x: x + cell / 2, y: y + 10, 'text-anchor': 'middle', 'font-size': 11, fill: '#586472' }, name);
    if (value !== null)
      figures.draw(svg, 'text', { x: x + cell / 2, y: y + 24, 'text-anchor': 'middle', 'font-size': 12,
        'font-weight': value === this.best(name) ? 700 : 400 }, formatError(value));
  }

  drawPicture(svg, picture, crop, [x, y, width, height], mode) {
    figures.draw(svg, 'image', { x, y, width, height, preserveAspectRatio: 'none', href: this.cropUrl(picture, crop, width, mode),
      style: 'image-rendering:pixelated' });
  }

  // --- plots -------------------------------------------------------------------------------------

  // Draws axes with grid lines and labels, and `words` below. If y.hasTicks is false, the vertical
  // axis has no lines and no labels.
  drawFrame(svg, x, y, words) {
    for (const value of x.ticks()) {
      const at = x.at(value);
      figures.draw(svg, 'line', { x1: at, y1: y.to, x2: at, y2: y.from, stroke: '#d9dfe6', 'stroke-width': 1 });
      figures.draw(svg, 'text', { x: at, y: y.from + 16, 'text-anchor': 'middle', 'font-size': 11 }, x.label(value));
    }
    for (const value of y.hasTicks === false ? [] : y.ticks()) {
      const at = y.at(value);
      figures.draw(svg, 'line', { x1: x.from, y1: at, x2: x.to, y2: at, stroke: '#d9dfe6', 'stroke-width': 1 });
      figures.draw(svg, 'text', { x: x.from - 6, y: at + 4, 'text-anchor': 'end', 'font-size': 11 }, y.label(value));
    }
    figures.draw(svg, 'line', { x1: x.from, y1: y.from, x2: x.to, y2: y.from, stroke: '#586472', 'stroke-width': 1 });
    figures.draw(svg, 'text', { x: (x.from + x.to) / 2, y: y.from + 34, 'text-anchor': 'middle' }, words);
  }

  // Draws the errors of all images in one metric, with 95 % intervals.
  drawIntervals() {
    const { viewer } = this, name = this.metricBox.value, ROW = 26, LEFT = 130, WIDTH = 560, TOP = 10;
    const rows = viewer.pictures.map((picture, i) => ({ picture, i, figure: picture.entry.figures.find(f => f.name === name) }))
      .filter(row => row.figure && row.figure.value !== null);
    const ends = [].concat(...rows.map(({ figure: f }) => [f.value, f.low, f.high].filter(v => v !== null)));
    const low = Math.min(...ends), high = Math.max(...ends), isLog = low > 0 && high > low;
    const bottom = TOP + rows.length * ROW + 4, svg = figures.create(WIDTH, bottom + 46);
    const margin = Math.max(high - low, Math.abs(high) * .1, 1e-12) * .08;
    const x = isLog ? new Axis(low / 1.15, high * 1.15, true, LEFT, WIDTH - 90) : new Axis(low - margin, high + margin, false, LEFT, WIDTH - 90);
    this.drawFrame(svg, x, { from: bottom, to: TOP, hasTicks: false }, `${name}, with intervals of 95 %`);
    rows.forEach(({ picture, i, figure }, row) => {
      const y = TOP + (row + .5) * ROW, color = figures.COLORS[i % figures.COLORS.length];
      figures.draw(svg, 'text', { x: LEFT - 10, y: y + 4, 'text-anchor': 'end' }, ViewerFigures.shorten(picture.label, LEFT - 14, 12));
      if (figure.low !== null && figure.high !== null) {
        // A bound that a logarithmic axis cannot show is drawn at the start of the axis.
        const from = isLog && !(figure.low > 0) ? x.from : x.at(figure.low), to = x.at(figure.high);
        figures.draw(svg, 'path', { d: `M${from},${y}H${to}M${from},${y - 5}V${y + 5}M${to},${y - 5}V${y + 5}`, fill: 'none', stroke: color, 'stroke-width': 1.6 });
      }
      figures.draw(svg, 'circle', { cx: x.at(figure.value), cy: y, r: 4, fill: color });
      figures.draw(svg, 'text', { x: WIDTH - 4, y: y + 4, 'text-anchor': 'end', 'font-weight': figure.value === this.best(name) ? 700 : 400 }, formatError(figure.value));
    });
    return svg;
  }

  // Returns the share of pixels whose error exceeds a value, for steps of the map's scale.
  shares(picture, map) {
    picture.shares = picture.shares || {};
    if (picture.shares[map.name]) return picture.shares[map.name];
    const BINS = 128, counts = new Float64Array(BINS + 1);
    let known = 0;
    for (const error of picture.errorsOf(map.name)) {
      const level = errorLevel(map, error);
      if (Number.isNaN(level)) continue;
      counts[Math.floor(level * BINS)]++;
      known++;
    }
    let above = known;
    picture.shares[map.name] = Array.from({ length: BINS + 1 }, (_, bin) => {
      const share = above / known; // share of the pixels at the start of this step or above
      above -= counts[bin];
      const level = bin / BINS;
      return { value: map.log ? map.low * (map.high / map.low) ** level : map.low + level * (map.high - map.low), share };
    });
    return picture.shares[map.name];
  }

  drawDistribution(map) {
    const { viewer } = this, WIDTH = 560, LEFT = 52, TOP = 12, BOTTOM = 236;
    const others = viewer.pictures.filter(p => !p.isReference), svg = figures.create(WIDTH, BOTTOM + 46);
    const x = new Axis(map.low, map.high, map.log, LEFT, WIDTH - 16), y = new Axis(0, 100, false, BOTTOM, TOP);
    this.drawFrame(svg, x, y, `pixels with an error above this, % (${map.name})`);
    others.forEach((picture, i) => {
      const points = this.shares(picture, map).map(({ value, share }) => `${x.at(value).toFixed(2)},${y.at(100 * share).toFixed(2)}`);
      const color = figures.COLORS[picture.index % figures.COLORS.length];
      figures.draw(svg, 'path', { d: `M${points.join('L')}`, fill: 'none', stroke: color, 'stroke-width': 1.8 });
      const top = TOP + 12 + 17 * i, label = ViewerFigures.shorten(picture.label, 130, 12);
      figures.draw(svg, 'line', { x1: WIDTH - 44, y1: top - 4, x2: WIDTH - 20, y2: top - 4, stroke: color, 'stroke-width': 3 });
      figures.draw(svg, 'text', { x: WIDTH - 50, y: top, 'text-anchor': 'end' }, label);
    });
    return svg;
  }
}

function formatStops(stops) {
  return `${stops > 0 ? '+' : ''}${stops} stops`.replace('-', '\u2212');
}
