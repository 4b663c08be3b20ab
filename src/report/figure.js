// The figures of a report. They are SVG elements of the page; this file also writes them to SVG and
// PDF files. The PDF writer supports the shapes that the figures of gnuplot and of this program
// have: paths, lines, rectangles, circles, polygons, text in one font, and images. It needs no
// library.
'use strict';

const figures = (() => {
  const SVG = 'http://www.w3.org/2000/svg';
  // The colours of Okabe and Ito (2008), which people with colour blindness can distinguish. Yellow
  // is omitted.
  const COLORS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#e69f00', '#000000'];

  // Makes an SVG element with attributes and appends it to `parent`.
  function draw(parent, name, attributes, text) {
    const element = document.createElementNS(SVG, name);
    for (const key of Object.keys(attributes || {})) element.setAttribute(key, attributes[key]);
    if (text !== undefined) element.textContent = text;
    if (parent) parent.appendChild(element);
    return element;
  }

  // Makes an empty figure in a font that PDF readers have as well.
  function create(width, height) {
    const svg = draw(null, 'svg', {
      xmlns: SVG, width, height, viewBox: `0 0 ${width} ${height}`,
      'font-family': "Helvetica, Arial, 'Liberation Sans', sans-serif", 'font-size': 12, fill: '#1b2430',
    });
    draw(svg, 'rect', { x: 0, y: 0, width, height, fill: '#ffffff' });
    return svg;
  }

  // --- SVG ---------------------------------------------------------------------------------------

  function toSvg(svg) {
    const text = new XMLSerializer().serializeToString(svg);
    return new TextEncoder().encode(`<?xml version="1.0" encoding="utf-8"?>\n${text}\n`);
  }

  // --- PDF ---------------------------------------------------------------------------------------

  // Widths of the characters 32 to 126 of Helvetica and Helvetica-Bold, in thousandths of the font
  // size, from Adobe's metrics of the standard fonts that every PDF reader has.
  const WIDTHS = [
    '278 278 355 556 556 889 667 191 333 333 389 584 278 333 278 278 556 556 556 556 556 556 556 556 556 556 278 278 ' +
    '584 584 584 556 1015 667 667 722 722 667 611 778 722 278 500 667 556 833 722 778 667 778 722 667 611 722 667 944 ' +
    '667 667 611 278 278 278 469 556 333 556 556 500 556 556 278 556 556 222 222 500 222 833 556 556 556 556 333 500 ' +
    '278 556 500 722 500 500 500 334 260 334 584',
    '278 333 474 556 556 889 722 238 333 333 389 584 278 333 278 278 556 556 556 556 556 556 556 556 556 556 333 333 ' +
    '584 584 584 611 975 722 722 722 722 667 611 778 722 278 556 722 611 833 722 778 667 778 722 667 611 722 667 944 ' +
    '667 667 611 333 278 333 584 556 333 556 611 556 611 556 333 611 611 278 278 556 278 889 611 611 611 611 389 556 ' +
    '333 611 556 778 556 556 500 389 280 389 584',
  ].map(list => list.split(' ').map(Number));
  // Codes in WinAnsiEncoding of characters beyond Latin-1. Characters that it lacks have the code
  // of a similar one.
  const WIN_ANSI = {
    '\u2212': 0x2d, '\u2026': 0x85, '\u2019': 0x92, '\u2018': 0x91, '\u201c': 0x93, '\u201d': 0x94, '\u2013': 0x96,
    '\u2014': 0x97, '\u2009': 0x20,
  };

  function winAnsi(text) {
    return Array.from(text).map(c => {
      const code = c.codePointAt(0);
      return code >= 0x20 && code < 0x7f || code >= 0xa0 && code < 0x100 ? code : WIN_ANSI[c] || 0x3f;
    });
  }

  function textWidth(codes, bold, size) {
    const widths = WIDTHS[bold ? 1 : 0];
    return codes.reduce((sum, code) => sum + (widths[code - 32] || 556), 0) * size / 1000;
  }

  const number = value => String(Math.round(value * 1000) / 1000);
  const matrix = m => [m.a, m.b, m.c, m.d, m.e, m.f].map(v => String(Math.round(v * 1e6) / 1e6)).join(' ');

  // Returns [r, g, b] in [0, 1], or null if nothing is painted.
  function color(text) {
    const found = /^rgba?\(([^)]*)\)/.exec(text);
    if (!found) return null;
    const [r, g, b, alpha] = found[1].split(/[,\s/]+/).map(Number);
    return alpha === 0 ? null : [r / 255, g / 255, b / 255];
  }

  // Returns the PDF operators of a path. Cubic Bezier curves are the only curves that occur.
  function pathOperators(d) {
    const tokens = d.match(/[a-zA-Z]|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?/g) || [];
    let out = '', command = '', x = 0, y = 0, startX = 0, startY = 0, at = 0;
    const next = () => Number(tokens[at++]);
    while (at < tokens.length) {
      if (/[a-zA-Z]/.test(tokens[at])) command = tokens[at++];
      const relative = command === command.toLowerCase();
      const originX = relative ? x : 0, originY = relative ? y : 0;
      switch (command.toUpperCase()) {
        case 'M':
          x = startX = originX + next(); y = startY = originY + next();
          out += `${number(x)} ${number(y)} m\n`;
          command = relative ? 'l' : 'L'; // further pairs of coordinates are lines
          continue;
        case 'L': x = originX + next(); y = originY + next(); break;
        case 'H': x = originX + next(); break;
        case 'V': y = originY + next(); break;
        case 'C': {
          const p = [0, 1, 2, 3].map(i => (i % 2 ? originY : originX) + next());
          x = originX + next(); y = originY + next();
          out += `${p.map(number).join(' ')} ${number(x)} ${number(y)} c\n`;
          continue;
        }
        case 'Z': out += 'h\n'; x = startX; y = startY; continue;
        default: throw new Error(`a path has the command ${command}, which the PDF writer does not know`);
      }
      out += `${number(x)} ${number(y)} l\n`;
    }
    return out;
  }

  // Returns a circle of four Bezier curves. Each control point is at a distance of 4/3 (sqrt(2) -
  // 1) radii from an end of its curve.
  function circleOperators(x, y, r) {
    const k = r * 4 / 3 * (Math.SQRT2 - 1);
    const curve = (...p) => `${p.map(number).join(' ')} c\n`;
    return `${number(x + r)} ${number(y)} m\n` +
      curve(x + r, y + k, x + k, y + r, x, y + r) + curve(x - k, y + r, x - r, y + k, x - r, y) +
      curve(x - r, y - k, x - k, y - r, x, y - r) + curve(x + k, y - r, x + r, y - k, x + r, y) + 'h\n';
  }

  function shapeOperators(element) {
    const get = name => Number(element.getAttribute(name)) || 0;
    switch (element.localName) {
      case 'path': return pathOperators(element.getAttribute('d') || '');
      case 'line': return `${get('x1')} ${get('y1')} m ${get('x2')} ${get('y2')} l\n`;
      case 'rect': return `${get('x')} ${get('y')} ${get('width')} ${get('height')} re\n`;
      case 'circle': return circleOperators(get('cx'), get('cy'), get('r'));
      case 'polyline':
      case 'polygon': {
        const points = (element.getAttribute('points') || '').trim();
        return pathOperators(`M${points}${element.localName === 'polygon' ? 'Z' : ''}`);
      }
      default: return null;
    }
  }

  async function deflate(bytes) {
    // In old browsers the streams are not compressed.
    if (typeof CompressionStream === 'undefined') return null;
    const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  const latin1 = text => Uint8Array.from(text, c => c.charCodeAt(0));

  // Assembles the numbered objects, the cross-reference table and the trailer (ISO 32000-1, 7.5).
  class PdfFile {
    constructor() {
      this.objects = [];
    }

    reserve() {
      return this.objects.push(null);
    }

    set(id, ...parts) {
      this.objects[id - 1] = parts.map(part => typeof part === 'string' ? latin1(part) : part);
      return id;
    }

    add(...parts) {
      return this.set(this.reserve(), ...parts);
    }

    async stream(entries, bytes) {
      const packed = await deflate(bytes);
      const filter = packed ? '/Filter /FlateDecode ' : '';
      const data = packed || bytes;
      return this.add(`<< ${entries} ${filter}/Length ${data.length} >>\nstream\n`, data, '\nendstream');
    }

    bytes(root) {
      const parts = [latin1('%PDF-1.4\n%\u00e2\u00e3\u00cf\u00d3\n')];
      let length = parts[0].length;
      const push = part => { parts.push(part); length += part.length; };
      const offsets = this.objects.map((object, i) => {
        const offset = length;
        push(latin1(`${i + 1} 0 obj\n`));
        object.forEach(push);
        push(latin1('\nendobj\n'));
        return offset;
      });
      const table = length;
      const rows = offsets.map(offset => `${String(offset).padStart(10, '0')} 00000 n \n`).join('');
      push(latin1(`xref\n0 ${offsets.length + 1}\n0000000000 65535 f \n${rows}trailer\n` +
        `<< /Size ${offsets.length + 1} /Root ${root} 0 R >>\nstartxref\n${table}\n%%EOF\n`));
      const out = new Uint8Array(length);
      let at = 0;
      for (const part of parts) { out.set(part, at); at += part.length; }
      return out;
    }
  }

  // Traverses an SVG element that is visible in the page, and collects PDF operators and images.
  class PdfPage {
    constructor(svg) {
      this.svg = svg;
      this.inverse = svg.getScreenCTM().inverse();
      this.content = '';
      this.pictures = []; // image elements, which get the names Im0, Im1, …
    }

    // Returns the transform from the element's coordinates to those of the figure.
    place(element) {
      return this.inverse.multiply(element.getScreenCTM());
    }

    // Sets colours and line style. Returns the operator that paints; '' if nothing is to be
    // painted.
    paint(element, own) {
      const style = getComputedStyle(element);
      const pick = name => {
        const text = element.getAttribute(name);
        return color(own && text && text.toLowerCase() === 'currentcolor' ? own : style[name]);
      };
      const fill = Number(style.fillOpacity) > 0 && element.localName !== 'line' ? pick('fill') : null;
      const width = parseFloat(style.strokeWidth);
      const stroke = Number(style.strokeOpacity) > 0 && width > 0 ? pick('stroke') : null;
      if (fill) this.content += `${fill.map(number).join(' ')} rg\n`;
      if (stroke) {
        const dashes = style.strokeDasharray === 'none' ? [] : style.strokeDasharray.split(/[,\s]+/).map(parseFloat);
        const join = { round: 1, bevel: 2 }[style.strokeLinejoin] || 0;
        const cap = { round: 1, square: 2 }[style.strokeLinecap] || 0;
        this.content += `${stroke.map(number).join(' ')} RG ${number(width)} w ${join} j ${cap} J ` +
          `[${dashes.map(number).join(' ')}] 0 d\n`;
      }
      return fill && stroke ? 'B\n' : fill ? 'f\n' : stroke ? 'S\n' : '';
    }

    shape(element, place, own) {
      const operators = shapeOperators(element);
      if (operators === null) return;
      this.content += `q ${matrix(place)} cm\n`;
      const painted = this.paint(element, own);
      this.content += painted ? `${operators}${painted}Q\n` : 'Q\n';
    }

    // Aligns the text as the browser does. Its width may differ, because the PDF has its own font.
    text(element) {
      const words = element.textContent;
      if (!words.trim() || !element.getNumberOfChars()) return;
      const style = getComputedStyle(element);
      const bold = Number(style.fontWeight) >= 600, size = parseFloat(style.fontSize);
      const codes = winAnsi(words), width = textWidth(codes, bold, size);
      const start = element.getStartPositionOfChar(0);
      const end = element.getEndPositionOfChar(element.getNumberOfChars() - 1);
      const share = { start: 0, middle: .5, end: 1 }[style.textAnchor] || 0;
      const x = start.x + share * (end.x - start.x - width);
      const ink = color(style.fill) || [0, 0, 0];
      const hex = codes.map(code => code.toString(16).padStart(2, '0')).join('');
      this.content += `q ${matrix(this.place(element))} cm ${ink.map(number).join(' ')} rg BT /F${bold ? 2 : 1} ` +
        `${number(size)} Tf 1 0 0 -1 ${number(x)} ${number(start.y)} Tm <${hex}> Tj ET Q\n`;
    }

    picture(element) {
      const get = name => Number(element.getAttribute(name)) || 0;
      this.content += `q ${matrix(this.place(element))} cm ${get('width')} 0 0 ${-get('height')} ${get('x')} ` +
        `${get('y') + get('height')} cm /Im${this.pictures.length} Do Q\n`;
      this.pictures.push(element);
    }

    use(element) {
      const name = element.getAttribute('href') || element.getAttribute('xlink:href') || '';
      const target = name.startsWith('#') ? this.svg.querySelector(`[id="${name.slice(1)}"]`) : null;
      if (!target) return;
      const own = target.transform.baseVal.consolidate();
      const place = this.place(element);
      this.shape(target, own ? place.multiply(own.matrix) : place, getComputedStyle(element).color);
    }

    walk(element) {
      for (const child of element.children) {
        if (child.localName === 'text') this.text(child);
        else if (child.localName === 'image') this.picture(child);
        else if (child.localName === 'use') this.use(child);
        else if (child.localName === 'g' || child.localName === 'a') this.walk(child);
        else if (child.localName !== 'defs') {
          if (shapeOperators(child) !== null) this.shape(child, this.place(child), null);
        }
      }
    }
  }

  // Returns the pixels of an image element, without alpha.
  async function pixelsOf(element) {
    const image = new Image();
    image.src = element.getAttribute('href') || element.getAttribute('xlink:href');
    await image.decode();
    const canvas = document.createElement('canvas');
    canvas.width = image.naturalWidth;
    canvas.height = image.naturalHeight;
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const rgba = context.getImageData(0, 0, canvas.width, canvas.height).data;
    const rgb = new Uint8Array(rgba.length / 4 * 3);
    for (let i = 0, j = 0; i < rgba.length; i += 4) {
      rgb[j++] = rgba[i]; rgb[j++] = rgba[i + 1]; rgb[j++] = rgba[i + 2];
    }
    return { width: canvas.width, height: canvas.height, rgb };
  }

  const POINTS = .75; // a CSS pixel is 1/96 inch, a point is 1/72 inch

  async function toPdf(svg) {
    const box = svg.viewBox.baseVal;
    const width = box.width || svg.clientWidth, height = box.height || svg.clientHeight;
    const page = new PdfPage(svg), file = new PdfFile();
    page.walk(svg);
    const tree = file.reserve();
    const font = name => file.add(`<< /Type /Font /Subtype /Type1 /BaseFont /${name} /Encoding /WinAnsiEncoding >>`);
    const fonts = [font('Helvetica'), font('Helvetica-Bold')];
    let names = '';
    for (let i = 0; i < page.pictures.length; i++) {
      const p = await pixelsOf(page.pictures[i]);
      const id = await file.stream(`/Type /XObject /Subtype /Image /Width ${p.width} /Height ${p.height} ` +
        '/ColorSpace /DeviceRGB /BitsPerComponent 8 /Interpolate false', p.rgb);
      names += `/Im${i} ${id} 0 R `;
    }
    const start = `${POINTS} 0 0 ${-POINTS} 0 ${number(height * POINTS)} cm 1 0 0 1 ${number(-box.x)} ${number(-box.y)} cm\n`;
    const content = await file.stream('', latin1(start + page.content));
    const leaf = file.add(`<< /Type /Page /Parent ${tree} 0 R /MediaBox [0 0 ${number(width * POINTS)} ` +
      `${number(height * POINTS)}] /Contents ${content} 0 R /Resources << /Font << /F1 ${fonts[0]} 0 R ` +
      `/F2 ${fonts[1]} 0 R >> /XObject << ${names}>> >> >>`);
    file.set(tree, `<< /Type /Pages /Kids [${leaf} 0 R] /Count 1 >>`);
    return file.bytes(file.add(`<< /Type /Catalog /Pages ${tree} 0 R >>`));
  }

  // --- the page ----------------------------------------------------------------------------------

  function save(bytes, name, type) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([bytes], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  function button(label, title, action) {
    const element = document.createElement('button');
    element.type = 'button';
    element.textContent = label;
    element.title = title;
    element.addEventListener('click', action);
    return element;
  }

  // Makes buttons that save a figure as it is when they are pressed. find() returns the SVG
  // element.
  function exportBar(name, find) {
    const bar = document.createElement('div');
    bar.className = 'figure-bar';
    bar.append('Save as ',
      button('SVG', `Save ${name}.svg`, () => save(toSvg(find()), `${name}.svg`, 'image/svg+xml')),
      button('PDF', `Save ${name}.pdf`, async () => save(await toPdf(find()), `${name}.pdf`, 'application/pdf')));
    return bar;
  }

  // Adds these buttons to the plots that are already in the page.
  function begin() {
    for (const plot of document.querySelectorAll('figure.plot'))
      plot.append(exportBar(plot.dataset.name, () => plot.querySelector('svg')));
  }

  return { COLORS, draw, create, toSvg, toPdf, button, exportBar, begin };
})();

document.addEventListener('DOMContentLoaded', figures.begin);
