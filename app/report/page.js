/* Figures of a report. Each <figure data-figure="ID"> is drawn from the JSON in the element of that id: a panel as results
   declare it (axes, series of points, rules, shades, marks) or a plane (metrics and regimes over two parameters). Scales and axes are
   d3's; all that is shown is SVG, so that it prints. */
'use strict';
(() => {
const COLOURS = ['#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9'];  // told apart by the colour-blind
const CIVIDIS = ['#00204D', '#00336F', '#39486B', '#575C6D', '#707173', '#8A8779', '#A69D75', '#C4B56C', '#E4CF5B', '#FFEA46'];
const REGIMES = {stable: '#E8E8E8', cycle: '#0072B2', bistable: '#E69F00', failed: '#7A0019'};
const SPARE = ['#009E73', '#CC79A7', '#56B4E9', '#F0E442', '#666666', '#000000'];
const PREFIXES = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n'], [1e-12, 'p']];

// ---------------------------------------------------------------- numbers and elements

const superscript = n => String(n).replace(/./g, c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);

/** A number as it is read: 8.450695·10⁻⁵. */
function show(value, digits = 7) {
  if (value === null || value === undefined || Number.isNaN(value)) return 'none';
  if (typeof value !== 'number') return String(value);
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  const size = Math.abs(value);
  const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
  const text = size !== 0 && (size < 1e-3 || size >= 1e6)
      ? `${Number(mantissa)}·10${superscript(Number(exponent))}` : String(Number(value.toPrecision(digits)));
  return text.replace(/^1·10/, '10').replace('-', '−');
}

/** The same with the digits that its error leaves meaningful. */
function withError(value, error) {
  if (typeof value !== 'number' || typeof error !== 'number' || !(error > 0)) return show(value);
  const digits = value === 0 ? 1 : Math.floor(Math.log10(Math.abs(value))) - Math.floor(Math.log10(error)) + 1;
  return `${show(value, Math.min(Math.max(digits, 1), 15))} ± ${show(error, 1)}`;
}

const unitOf = quantity => quantity.unit && quantity.unit !== '1' ? quantity.unit : '';
const nameOf = quantity => quantity.symbol ? `${quantity.name} ${quantity.symbol}` : quantity.name;

/** Prefix of the unit, or power of ten, that suits the largest value. */
function scaled(quantity, largest) {
  const unit = unitOf(quantity);
  if (!(largest > 0) || !Number.isFinite(largest)) return {factor: 1, unit};
  if (/^(m|N|s|Hz|W|J|Pa)(?![a-z])/.test(unit)) {
    const found = PREFIXES.find(([size]) => largest >= size * 0.999);
    const [size, prefix] = found || PREFIXES[PREFIXES.length - 1];
    return {factor: 1 / size, unit: prefix + unit};
  }
  if (largest >= 0.01 && largest < 20000) return {factor: 1, unit};
  const exponent = 3 * Math.floor(Math.log10(largest) / 3);
  return {factor: 10 ** -exponent, unit: `10${superscript(exponent)}${unit ? ' ' + unit : ''}`};
}

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes))
    if (key.startsWith('on')) made.addEventListener(key.slice(2), value);
    else made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function choice(label, options, chosen, changed) {
  const select = element('select', {onchange: () => changed(Number(select.value))});
  options.forEach((text, i) => select.append(element('option', {value: i}, text)));
  select.value = chosen;
  return element('label', {}, label + ' ', select);
}

/** "name symbol = value unit", with the exact number for whoever reads the page by program. */
function reading(quantity, value, error) {
  const exact = element('data', {value: value === null ? '' : value, 'data-quantity': quantity.name}, withError(value, error));
  return element('span', {class: 'reading'}, `${nameOf(quantity)} = `, exact, unitOf(quantity) && value !== null ? ` ${unitOf(quantity)}` : '');
}

function copyButton(text) {
  const button = element('button', {type: 'button', class: 'copy', onclick: async () => {
    try {
      await navigator.clipboard.writeText(text());
    } catch (refused) {  // some browsers keep the clipboard from files
      const area = element('textarea', {}, text());
      document.body.append(area);
      area.select();
      document.execCommand('copy');
      area.remove();
    }
    button.textContent = 'Copied';
    setTimeout(() => { button.textContent = 'Copy'; }, 1500);
  }}, 'Copy');
  return button;
}

// ---------------------------------------------------------------- what curves and planes have in common

/** One pair of axes in which one zooms by wheel, by a rectangle dragged with the mouse, by buttons and keys. */
class Plot {
  constructor(figure, title) {
    this.controls = element('div', {class: 'controls'});
    this.area = element('div', {class: 'area', tabindex: 0, role: 'group', 'aria-roledescription': 'interactive figure',
      'aria-label': `${title}. ${this.keys()}`});
    this.readout = element('output', {class: 'readout', 'aria-live': 'polite'}, this.keys());
    this.svg = d3.select(this.area).append('svg').attr('role', 'img').attr('aria-label', title);
    figure.prepend(this.controls, this.area, this.readout);
    this.zoomed = null;
    const button = (text, label, does) => element('button', {type: 'button', 'aria-label': label, title: label, onclick: does}, text);
    this.buttons = element('span', {class: 'buttons'}, button('+', 'Zoom in', () => this.zoom(0.5)),
      button('−', 'Zoom out', () => this.zoom(2)), button('Reset', 'Show all', () => this.reset()));
    this.listen();
    this.width = 0;
    new ResizeObserver(() => {
      if (Math.abs(this.area.clientWidth - this.width) > 1 && !this.printing) this.draw();
    }).observe(this.area);
    window.addEventListener('beforeprint', () => { this.printing = true; });
    window.addEventListener('afterprint', () => { this.printing = false; });
  }

  /** Scales, axes and grid of the figure's size; the inner part, in which data are drawn, is returned. */
  frame(x, y) {
    this.width = this.area.clientWidth || 640;
    this.height = Math.round(Math.min(420, Math.max(260, this.width * 0.55)));
    this.margin = {left: 62, right: this.right || 14, top: 10, bottom: 44};
    const {left, right, top, bottom} = this.margin;
    this.svg.attr('viewBox', `0 0 ${this.width} ${this.height}`);
    this.svg.selectAll('*').remove();
    const scale = (axis, range, [low, high]) => (axis.log ? d3.scaleLog() : d3.scaleLinear()).domain([low, high]).range(range);
    const shown = this.zoomed || {x: x.extent, y: y.extent};
    this.x = scale(x, [left, this.width - right], shown.x);
    this.y = scale(y, [this.height - bottom, top], shown.y);
    this.axes = {x, y};
    const clip = `clip-${plots.indexOf(this)}`;
    this.svg.append('clipPath').attr('id', clip).append('rect').attr('x', left).attr('y', top)
      .attr('width', Math.max(1, this.width - left - right)).attr('height', this.height - top - bottom);
    this.axis(x, this.x, 'x');
    this.axis(y, this.y, 'y');
    return this.svg.append('g').attr('clip-path', `url(#${clip})`);
  }

  axis(quantity, scale, which) {
    const {left, right, top, bottom} = this.margin, across = which === 'x';
    const [low, high] = scale.domain(), decades = quantity.log ? Math.abs(Math.log10(high / low)) : 0;
    const unit = quantity.log ? {factor: 1, unit: unitOf(quantity)} : scaled(quantity, Math.max(Math.abs(low), Math.abs(high)));
    const count = across ? Math.max(3, this.width / 110) : 6;
    let ticks = quantity.ticks && !this.zoomed ? quantity.ticks.map(([at]) => at) : quantity.log && decades >= 1 ? scale.ticks(count) : d3.ticks(low, high, count);
    if (decades >= 2) ticks = ticks.filter(tick => Math.abs(Math.log10(tick) % 1) < 1e-9 || Math.abs(Math.log10(tick) % 1) > 1 - 1e-9);
    else if (decades >= 1 && !quantity.ticks) ticks = ticks.filter(tick => [1, 2, 5].includes(Math.round(tick / 10 ** Math.floor(Math.log10(tick) + 1e-9))));
    if (decades >= 2 && ticks.length > count + 1) {
      const every = Math.ceil(ticks.length / count);
      ticks = ticks.filter((_, i) => i % every === 0);
    }
    const within = tick => !quantity.within || (tick >= quantity.within[0] && tick <= quantity.within[1]);
    ticks = ticks.filter(within);
    const extra = quantity.extra || [];  // values outside the scale, which stand beside it
    const label = tick => {
      const named = !this.zoomed && (quantity.ticks || []).find(([at]) => at === tick);
      if (named) return named[1];
      const beside = extra.find(entry => entry.at === tick);
      return beside ? show(beside.value, 3) : show(tick * unit.factor, 5);
    };
    const all = ticks.concat(extra.map(entry => entry.at).filter(at => at >= Math.min(low, high) && at <= Math.max(low, high)));
    const make = (across ? d3.axisBottom : d3.axisLeft)(scale).tickValues(all).tickFormat(label).tickSizeOuter(0)
      .tickSizeInner(this.gridless ? 5 : across ? -(this.height - top - bottom) : -(this.width - left - right)).tickPadding(7);
    this.svg.append('g').attr('class', 'axis')
      .attr('transform', across ? `translate(0,${this.height - bottom})` : `translate(${left},0)`).call(make);
    this.svg.append('text').attr('class', 'axis-label').attr('text-anchor', 'middle')
      .attr('transform', across ? `translate(${(left + this.width - right) / 2},${this.height - 6})`
                                : `translate(13,${(top + this.height - bottom) / 2}) rotate(-90)`)
      .text(nameOf(quantity) + (unit.unit ? ` (${unit.unit})` : ''));
  }

  position(event) {
    const box = this.area.querySelector('svg').getBoundingClientRect();
    const ratio = this.width / box.width;
    return [(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio];
  }

  /** The rectangle of the picture between two corners becomes what is shown. */
  show([x0, y0], [x1, y1]) {
    const sorted = (scale, a, b) => [scale.invert(a), scale.invert(b)].sort((p, q) => p - q);
    const zoomed = {x: sorted(this.x, x0, x1), y: sorted(this.y, y0, y1)};
    const enough = ([low, high], log) => log ? Math.log(high / low) > 1e-9 : high - low > 1e-12 * Math.max(Math.abs(low), Math.abs(high));
    if (!enough(zoomed.x, this.axes.x.log) || !enough(zoomed.y, this.axes.y.log)) return;
    this.zoomed = zoomed;
    this.draw();
  }

  zoom(factor, [px, py] = this.centre()) {
    const {left, right, top, bottom} = this.margin;
    const toward = (p, edge) => p + (edge - p) * factor;
    this.show([toward(px, left), toward(py, this.height - bottom)], [toward(px, this.width - right), toward(py, top)]);
  }

  centre() {
    const {left, right, top, bottom} = this.margin;
    return this.cursor() || [(left + this.width - right) / 2, (top + this.height - bottom) / 2];
  }

  reset() {
    this.zoomed = null;
    this.draw();
  }

  listen() {
    const area = this.area;
    let from = null, box = null;
    area.addEventListener('wheel', event => {
      if (Plot.scrolling(area)) return;  // the page is scrolled, and this figure only passes under the pointer
      event.preventDefault();
      this.zoom(Math.exp(Math.sign(event.deltaY) * 0.2), this.position(event));
    }, {passive: false});
    area.addEventListener('pointerdown', event => {
      if (event.pointerType !== 'touch' && event.button === 0) from = this.position(event);
    });
    area.addEventListener('pointermove', event => {
      const to = this.position(event);
      if (!from) return this.hover(to);
      if (!box && Math.hypot(to[0] - from[0], to[1] - from[1]) > 5) {
        area.setPointerCapture(event.pointerId);
        box = this.svg.append('rect').attr('class', 'box');
      }
      if (box) box.attr('x', Math.min(from[0], to[0])).attr('y', Math.min(from[1], to[1]))
        .attr('width', Math.abs(to[0] - from[0])).attr('height', Math.abs(to[1] - from[1]));
    });
    area.addEventListener('pointerup', event => {
      const to = this.position(event), start = from, dragged = box;
      from = box = null;
      if (dragged) {
        dragged.remove();
        if (Math.abs(to[0] - start[0]) > 5 && Math.abs(to[1] - start[1]) > 5) this.show(start, to);
      } else {
        this.hover(to);
        this.choose(to);
      }
    });
    area.addEventListener('pointercancel', () => {
      if (box) box.remove();
      from = box = null;
    });
    area.addEventListener('dblclick', () => this.reset());
    area.addEventListener('keydown', event => {
      const arrow = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (arrow) this.step(arrow, event.shiftKey ? 10 : 1);
      else if (event.key === '+' || event.key === '=') this.zoom(0.5);
      else if (event.key === '-') this.zoom(2);
      else if (event.key === '0' || event.key === 'Escape') this.reset();
      else return;
      event.preventDefault();
    });
  }

  say(...parts) { this.readout.replaceChildren(...parts); }

  /** True while a turn of the wheel that began elsewhere goes on. */
  static scrolling(area) {
    const now = performance.now(), going = now - Plot.last < 250 && Plot.over !== area;
    Plot.last = now;
    if (!going) Plot.over = area;
    return going;
  }
}
Plot.last = -1e9;
Plot.over = null;
window.addEventListener('wheel', event => {
  if (event.target.closest('.area')) return;
  Plot.last = performance.now();
  Plot.over = null;
}, {passive: true});

// ---------------------------------------------------------------- curves

class Curves extends Plot {
  constructor(figure, data) {
    super(figure, data.title);
    this.data = data;
    this.at = null;  // series and sample under the cursor
    this.controls.append(this.buttons);
    this.legend();
  }

  keys() { return 'Drag or turn the wheel to zoom; arrow keys step along the curve, + − 0 zoom.'; }

  /** Colours of the lines' own styles are the page's, on light ground and on dark. */
  look({like, dash}) { return {colour: like === undefined ? 'var(--faint)' : COLOURS[like % COLOURS.length], dash: dash || ''}; }

  legend() {
    const list = element('ul', {class: 'legend'}), named = new Set();
    for (const entry of [...this.data.series, ...(this.data.rules || []), ...(this.data.shades || []), ...(this.data.marks || [])]) {
      const name = entry.name || (entry.how ? '' : entry.title);
      if (!name || named.has(name)) continue;
      named.add(name);
      const {colour, dash} = this.look(entry), item = element('li', {}, '');
      const svg = d3.select(item).append('svg').attr('width', 34).attr('height', 12).attr('aria-hidden', 'true');
      if (entry.how === 'points' || entry.text !== undefined) svg.append('circle').attr('cx', 17).attr('cy', 6).attr('r', 4).attr('fill', colour);
      else if (['filled', 'band'].includes(entry.how) || entry.colour) svg.append('rect').attr('class', 'band').attr('width', 34).attr('height', 12);
      else svg.append('line').attr('x1', 1).attr('x2', 33).attr('y1', 6).attr('y2', 6).attr('stroke', colour)
        .attr('stroke-width', 2).attr('stroke-dasharray', dash);
      item.append(` ${name}`);
      list.append(item);
    }
    if (named.size) this.readout.after(list);
  }

  /** An axis with the range of what is shown along it. */
  quantity(which) {
    const quantity = this.data[which];
    const values = this.data.series.flatMap(series => which === 'y' && series.upper ? series.y.concat(series.upper) : series[which])
      .concat((this.data.marks || []).map(mark => mark[which]), (this.data.rules || []).filter(rule => rule.axis === which).map(rule => rule.at),
        this.data.series.some(series => which === 'y' && ['bars', 'filled'].includes(series.how)) ? [0] : []);
    const log = Boolean(quantity.log) && values.some(value => value > 0);
    let [low, high] = [Infinity, -Infinity];
    for (const value of values)
      if (typeof value === 'number' && (!log || value > 0)) low = Math.min(low, value), high = Math.max(high, value);
    if (!(low <= high)) [low, high] = log ? [0.1, 1] : [0, 1];
    const margin = log ? Math.max(1.02, (high / low) ** 0.03) : low === high ? Math.abs(low) * 0.1 || 1 : (high - low) * 0.04;
    const around = log ? [low / margin, high * margin] : [low - margin, high + margin];
    return {...quantity, log, extent: [quantity.from ?? around[0], quantity.to ?? around[1]]};
  }

  draw() {
    const inner = this.frame(this.quantity('x'), this.quantity('y')), along = which => which === 'x' ? this.x : this.y;
    for (const {axis, from, to} of this.data.shades || []) {
      const [low, high] = [along(axis)(from), along(axis)(to)].sort((p, q) => p - q), across = axis === 'x';
      inner.append('rect').attr('class', 'band').attr(across ? 'x' : 'y', low).attr(across ? 'width' : 'height', Math.max(0.5, high - low))
        .attr(across ? 'y' : 'x', 0).attr(across ? 'height' : 'width', across ? this.height : this.width);
    }
    for (const series of this.data.series) this.drawSeries(inner, series);
    for (const rule of (this.data.rules || []).concat(['x', 'y'].filter(axis => this.data[axis].zero).map(axis => ({axis, at: 0})))) {
      const at = along(rule.axis)(rule.at), across = rule.axis === 'x';
      if (Number.isFinite(at)) inner.append('line').attr('class', 'mark').attr('stroke-dasharray', rule.dash || '')
        .attr(across ? 'x1' : 'y1', at).attr(across ? 'x2' : 'y2', at).attr(across ? 'y1' : 'x1', 0)
        .attr(across ? 'y2' : 'x2', across ? this.height : this.width);
    }
    for (const mark of this.data.marks || []) {
      const x = this.x(mark.x), y = this.y(mark.y);
      if (!Number.isFinite(x) || !Number.isFinite(y)) continue;
      if (mark.point) inner.append('circle').attr('cx', x).attr('cy', y).attr('r', 4).attr('fill', this.look(mark).colour);
      const left = mark.side === 'left' || x > 0.85 * this.width;
      if (mark.text) inner.append('text').attr('class', 'mark-label').attr('text-anchor', left ? 'end' : 'start')
        .attr('x', x + (left ? -7 : 7)).attr('y', y + (mark.side === 'above' ? -7 : 4)).text(mark.text);
    }
    (this.data.notes || []).forEach((note, i) => inner.append('text').attr('class', 'mark-label').attr('text-anchor', 'end')
      .attr('x', this.width - this.margin.right - 8).attr('y', this.margin.top + 16 * (i + 1)).text(note));
    this.pointer = inner.append('circle').attr('class', 'cursor').attr('r', 5).attr('display', 'none');
    this.point();
  }

  drawSeries(inner, series) {
    const {colour, dash} = this.look(series), {how, x: xs, y: ys, upper} = series;
    const place = (k, values) => [this.x(xs[k]), this.y(values[k])];
    const known = (k, values = ys) => xs[k] !== null && values[k] !== null && place(k, values).every(Number.isFinite);
    const samples = d3.range(xs.length);
    if (how.endsWith('points'))
      for (const k of samples.filter(k => known(k))) {
        const [x, y] = place(k, ys);
        inner.append('circle').attr('cx', x).attr('cy', y).attr('r', xs.length > 300 ? 1.3 : 3).attr('fill', colour);
      }
    if (how === 'points') return;
    if (how === 'upright' || how === 'bars') {
      for (const k of samples.filter(k => known(k)))
        inner.append('line').attr('x1', this.x(xs[k])).attr('x2', this.x(xs[k])).attr('y1', how === 'bars' ? this.y(0) : 0)
          .attr('y2', how === 'bars' ? this.y(ys[k]) : this.height).attr('stroke', colour).attr('stroke-width', how === 'bars' ? 12 : 1);
      return;
    }
    const path = values => {
      let text = '', pen = 'M', before = null;
      for (const k of samples) {
        if (!known(k, values)) { pen = 'M'; continue; }
        const [x, y] = place(k, values);
        text += `${how === 'steps' && pen === 'L' ? `L${x.toFixed(2)},${before.toFixed(2)}` : ''}${pen}${x.toFixed(2)},${y.toFixed(2)}`;
        pen = 'L', before = y;
      }
      return text;
    };
    if (how === 'band' || how === 'filled') {
      const base = how === 'band' ? null : this.y(Math.max(0, this.y.domain()[0]));
      const area = d3.range(xs.length).filter(k => known(k) && (!upper || known(k, upper)));
      const edge = (values, list) => list.map(k => `${this.x(xs[k]).toFixed(2)},${(values ? this.y(values[k]) : base).toFixed(2)}`);
      if (area.length) inner.append('path').attr('d', `M${[...edge(ys, area), ...edge(upper, [...area].reverse())].join('L')}Z`)
        .attr('fill', colour).attr('fill-opacity', 0.25);
      return;
    }
    inner.append('path').attr('class', 'curve').attr('d', path(ys)).attr('stroke', colour).attr('stroke-dasharray', dash);
  }

  sample() { return this.at && [this.data.series[this.at.series].x[this.at.sample], this.data.series[this.at.series].y[this.at.sample]]; }

  cursor() { return this.at && [this.x(this.sample()[0]), this.y(this.sample()[1])]; }

  point() {
    if (!this.at || !this.pointer) return;
    const [px, py] = this.cursor(), [x, y] = this.sample(), {name} = this.data.series[this.at.series];
    if (Number.isFinite(px) && Number.isFinite(py)) this.pointer.attr('cx', px).attr('cy', py).attr('display', null);
    const said = name && this.data.series.length > 1 ? [element('strong', {}, `${name}: `)] : [];
    this.say(...said, reading(this.data.x, x, this.data.x.error), ', ', reading(this.data.y, y, this.data.y.error));
  }

  hover([px, py]) {
    let best = null, least = Infinity;
    this.data.series.forEach(({x, y}, series) => {
      for (let k = 0; k < x.length; ++k) {
        if (x[k] === null || y[k] === null) continue;
        const apart = (this.x(x[k]) - px) ** 2 + (0.5 * (this.y(y[k]) - py)) ** 2;
        if (apart < least) least = apart, best = {series, sample: k};
      }
    });
    this.at = best;
    this.point();
  }

  choose() {}

  step([along, across], far) {
    const {series} = this.data;
    if (!series.length) return;
    if (!this.at) this.at = {series: 0, sample: 0};
    else {
      this.at.series = (this.at.series - across + series.length) % series.length;
      const last = series[this.at.series].x.length - 1;
      this.at.sample = Math.min(last, Math.max(0, this.at.sample + along * far));
    }
    this.point();
  }

  rows() {
    const heading = quantity => nameOf(quantity) + (unitOf(quantity) ? ` (${unitOf(quantity)})` : '');
    const many = this.data.series.length > 1, header = [...(many ? ['line'] : []), heading(this.data.x), heading(this.data.y)];
    const rows = [];
    for (const {name, x, y} of this.data.series)
      x.forEach((value, k) => rows.push([...(many ? [name] : []), show(value), show(y[k])]));
    return {header, rows};
  }
}

// ---------------------------------------------------------------- planes

class Plane extends Plot {
  constructor(figure, data) {
    super(figure, data.title);
    this.data = data;
    this.gridless = true;
    this.layer = data.layer || 0;
    this.cell = null;
    const names = data.layers.map(nameOf);
    if (names.length > 1) this.controls.append(choice('Shown', names, this.layer, i => { this.layer = i; this.draw(); }));
    this.controls.append(this.buttons);
    this.details = element('div', {class: 'details', 'aria-live': 'polite'});
    this.key = element('ul', {class: 'legend'});
    this.readout.after(this.key, this.details);
  }

  keys() { return 'Drag or turn the wheel to zoom; click a point, or go there by arrow keys, for its numbers; + − 0 zoom.'; }

  /** Colours of a layer: of its words, or of its numbers, by decades where they span many. */
  colours(layer) {
    if (layer.words) {
      let spare = 0;
      const table = Object.fromEntries(layer.words.map(word => [word, REGIMES[word] || SPARE[spare++ % SPARE.length]]));
      return {words: table, of: value => value === null ? null : table[value]};
    }
    const numbers = layer.values.flat().filter(value => typeof value === 'number');
    let low = Infinity, high = -Infinity, least = Infinity;
    for (const value of numbers) {
      low = Math.min(low, value), high = Math.max(high, value);
      if (value > 0) least = Math.min(least, value);
    }
    if (!numbers.length) return {of: () => null};
    const shallow = layer.decades && high > 0;  // 0 among numbers of many sizes: what is five decades below the largest is as good
    if (shallow) low = Math.max(least, 1e-5 * high);
    const log = shallow || (low > 0 && high / low > 100);
    const scale = (log ? d3.scaleLog() : d3.scaleLinear()).domain(low === high ? [low, low + (Math.abs(low) || 1)] : [low, high])
      .range([0, 1]).clamp(true);
    const colour = share => {
      const at = Math.min(Math.max(share, 0), 1) * (CIVIDIS.length - 1), i = Math.min(Math.floor(at), CIVIDIS.length - 2);
      return mix(CIVIDIS[i], CIVIDIS[i + 1], at - i);
    };
    return {low, high, log, colour, of: value => typeof value !== 'number' ? null : colour(log && value <= 0 ? 0 : scale(value))};
  }

  draw() {
    const {x, y} = this.data, layer = this.data.layers[this.layer];
    const of = this.colours(layer);
    const axis = quantity => ({...quantity, extent: [Math.min(...quantity.low), Math.max(...quantity.high)]});
    const inner = this.frame(axis(x), axis(y));
    const {left, right, top, bottom} = this.margin;
    const wide = this.width - left - right, high = this.height - top - bottom, fine = 2;
    const canvas = element('canvas', {width: Math.round(wide * fine), height: Math.round(high * fine)});
    const paint = canvas.getContext('2d');
    layer.values.forEach((row, iy) => row.forEach((value, ix) => {
      const colour = of.of(value);
      if (!colour) return;
      const x0 = (this.x(x.low[ix]) - left) * fine, x1 = (this.x(x.high[ix]) - left) * fine;
      const y0 = (this.y(y.high[iy]) - top) * fine, y1 = (this.y(y.low[iy]) - top) * fine;
      if (x1 < 0 || y1 < 0 || x0 > canvas.width || y0 > canvas.height) return;
      paint.fillStyle = colour;
      paint.fillRect(Math.floor(x0), Math.floor(y0), Math.ceil(x1) - Math.floor(x0), Math.ceil(y1) - Math.floor(y0));
    }));
    inner.append('rect').attr('class', 'empty').attr('x', left).attr('y', top).attr('width', wide).attr('height', high);
    inner.append('image').attr('x', left).attr('y', top).attr('width', wide).attr('height', high)
      .attr('preserveAspectRatio', 'none').attr('href', canvas.toDataURL());
    for (const line of this.data.lines || []) {
      const path = line.x.map((at, i) => `${i ? 'L' : 'M'}${this.x(at).toFixed(2)},${this.y(line.y[i]).toFixed(2)}`).join('');
      if (!/NaN/.test(path)) {
        inner.append('path').attr('class', 'halo').attr('d', path);
        inner.append('path').attr('class', 'line').attr('d', path).attr('stroke-dasharray', line.dash || '');
      }
    }
    for (const spot of this.data.spots || []) {
      inner.append('circle').attr('class', 'halo').attr('cx', this.x(spot.x)).attr('cy', this.y(spot.y)).attr('r', 7);
      inner.append('circle').attr('class', 'line').attr('cx', this.x(spot.x)).attr('cy', this.y(spot.y)).attr('r', 7);
    }
    const regime = this.data.layers.find(other => other.words && other.words.includes('failed'));
    if (regime) regime.values.forEach((row, iy) => row.forEach((word, ix) => {
      if (word === 'failed') inner.append('text').attr('class', 'failed').attr('x', this.x(x.at[ix])).attr('y', this.y(y.at[iy]) + 4).text('×');
    }));
    this.pointer = inner.append('g').attr('display', 'none');
    for (const look of ['halo', 'line']) this.pointer.append('rect').attr('class', look);
    this.colourKey(layer, of);
    this.point();
  }

  colourKey(layer, of) {
    const swatch = colour => {
      const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
      d3.select(svg).attr('width', 16).attr('height', 16).attr('aria-hidden', 'true').append('rect').attr('width', 16).attr('height', 16)
        .attr('class', 'swatch').attr('fill', colour);
      return svg;
    };
    this.key.replaceChildren();
    if (of.words)
      for (const word of layer.words) this.key.append(element('li', {}, swatch(of.words[word]), ` ${word}`));
    else if (of.colour) {
      const item = element('li', {class: 'scale'});
      const svg = d3.select(item).append('svg').attr('width', 160).attr('height', 12).attr('aria-hidden', 'true');
      for (let i = 0; i < 40; ++i) svg.append('rect').attr('x', i * 4).attr('width', 4.5).attr('height', 12).attr('fill', of.colour(i / 39));
      item.prepend(`${nameOf(layer)}: ${show(of.low, 3)} `);
      item.append(` ${show(of.high, 3)}${unitOf(layer) && ' ' + unitOf(layer)}${of.log ? ', by decades' : ''}`);
      this.key.append(item);
      if (layer.values.some(row => row.includes(null))) this.key.append(element('li', {}, swatch('var(--empty)'), ' none'));
    }
    for (const line of this.data.lines || []) {
      const item = element('li', {});
      const svg = d3.select(item).append('svg').attr('width', 34).attr('height', 12).attr('aria-hidden', 'true');
      svg.append('line').attr('x1', 1).attr('x2', 33).attr('y1', 6).attr('y2', 6).attr('class', 'key-line').attr('stroke-dasharray', line.dash || '');
      item.append(` ${line.name}`);
      this.key.append(item);
    }
    for (const spot of this.data.spots || []) this.key.append(element('li', {}, `○ ${spot.name}`));
  }

  find([px, py]) {
    const within = (axis, scale, p) => {
      const value = scale.invert(p);
      return axis.low.findIndex((low, i) => value >= low && value <= axis.high[i]);
    };
    const ix = within(this.data.x, this.x, px), iy = within(this.data.y, this.y, py);
    return ix < 0 || iy < 0 ? null : {ix, iy};
  }

  cursor() { return this.cell && [this.x(this.data.x.at[this.cell.ix]), this.y(this.data.y.at[this.cell.iy])]; }

  hover(at) {
    const cell = this.find(at);
    if (cell) this.read(cell);
  }

  read({ix, iy}) {
    const {x, y} = this.data, layer = this.data.layers[this.layer], error = layer.error && layer.error[iy][ix];
    this.say(reading(x, x.values[ix]), ', ', reading(y, y.values[iy]), ': ', reading(layer, layer.values[iy][ix], error));
  }

  choose(at) {
    const cell = this.find(at);
    if (!cell) return;
    this.cell = cell;
    this.point();
    this.tell();
  }

  step([right, up], far) {
    const {x, y} = this.data, order = axis => axis.at.map((_, i) => i).sort((a, b) => axis.at[a] - axis.at[b]);
    const move = (axis, i, by) => {
      const list = order(axis), place = list.indexOf(i) + by * far;
      return list[Math.min(list.length - 1, Math.max(0, place))];
    };
    this.cell = this.cell ? {ix: move(x, this.cell.ix, right), iy: move(y, this.cell.iy, up)} : {ix: order(x)[0], iy: order(y)[0]};
    this.point();
    this.tell();
  }

  point() {
    if (!this.cell || !this.pointer) return;
    const {x, y} = this.data, {ix, iy} = this.cell, x0 = this.x(x.low[ix]), y0 = this.y(y.high[iy]);
    this.pointer.attr('display', null).selectAll('rect').attr('x', x0).attr('y', y0)
      .attr('width', this.x(x.high[ix]) - x0).attr('height', this.y(y.low[iy]) - y0);
    this.read(this.cell);
  }

  /** All numbers of the chosen point, and how to compute what happens there. */
  tell() {
    const {x, y, layers, command} = this.data, {ix, iy} = this.cell;
    const table = element('table', {}, element('caption', {}, 'The chosen point'));
    const row = (quantity, value, error) => table.append(element('tr', {}, element('th', {scope: 'row'}, nameOf(quantity)),
      element('td', {}, element('data', {value: value === null ? '' : value, 'data-quantity': quantity.name}, withError(value, error)),
        unitOf(quantity) && value !== null ? ` ${unitOf(quantity)}` : '')));
    row(x, x.values[ix]);
    row(y, y.values[iy]);
    for (const layer of layers) row(layer, layer.values[iy][ix], layer.error && layer.error[iy][ix]);
    const parts = [table];
    const failed = (this.data.failures || []).find(failure => failure.ix === ix && failure.iy === iy);
    if (failed) parts.push(element('p', {}, `Failed: ${failed.why}`));
    const spot = (this.data.spots || []).find(other => other.ix === ix && other.iy === iy);
    if (spot) parts.push(element('p', {}, element('a', {href: spot.link}, spot.text)));
    if (command) {
      const line = `${command} --set ${x.parameter}=${x.values[ix]} --set ${y.parameter}=${y.values[iy]}`;
      parts.push(element('p', {}, 'What happens there, computed by'),
        element('pre', {class: 'command', tabindex: 0}, line), copyButton(() => line));
    }
    this.details.replaceChildren(...parts);
  }

  rows() {
    const {x, y, layers} = this.data, header = [x, y, ...layers].map(q => nameOf(q) + (unitOf(q) ? ` (${unitOf(q)})` : ''));
    const rows = [];
    y.values.forEach((down, iy) => x.values.forEach((across, ix) =>
      rows.push([show(across), show(down), ...layers.map(layer => withError(layer.values[iy][ix], layer.error && layer.error[iy][ix]))])));
    return {header, rows};
  }
}

function mix(from, to, share) {
  const part = (colour, i) => parseInt(colour.slice(1 + 2 * i, 3 + 2 * i), 16);
  return `rgb(${[0, 1, 2].map(i => Math.round(part(from, i) + (part(to, i) - part(from, i)) * share)).join(',')})`;
}

// ---------------------------------------------------------------- the page

/** The figure's numbers as a table, made when it is opened: long ones would make every page slow. */
function numbers(plot, figure) {
  const most = 500;
  const details = element('details', {class: 'numbers'}, element('summary', {}, 'Numbers of this figure'));
  details.addEventListener('toggle', () => {
    if (!details.open || details.querySelector('table')) return;
    const {header, rows} = plot.rows(), table = element('table', {});
    table.append(element('thead', {}, element('tr', {}, ...header.map(text => element('th', {scope: 'col'}, text)))));
    const body = element('tbody');
    for (const row of rows.slice(0, most)) body.append(element('tr', {}, ...row.map(text => element('td', {}, text))));
    table.append(body);
    details.append(element('div', {class: 'wide', tabindex: 0, role: 'region', 'aria-label': 'Numbers of this figure'}, table));
    if (rows.length > most) details.append(element('p', {}, `The first ${most} of ${rows.length} rows; all stand in the results folder.`));
  });
  figure.append(details);
}

const plots = [];
for (const figure of document.querySelectorAll('figure[data-figure]')) {
  const data = JSON.parse(document.getElementById(figure.dataset.figure).textContent);
  const plot = data.kind === 'plane' ? new Plane(figure, data) : new Curves(figure, data);
  plots.push(plot);
  plot.draw();
  numbers(plot, figure);
}
// On paper nothing can be opened: scenes and parameters are printed.
const folded = () => document.querySelectorAll('details:not(.numbers)');
window.addEventListener('beforeprint', () => {
  for (const details of folded()) {
    details.dataset.was = details.open ? 'open' : '';
    details.open = true;
  }
});
window.addEventListener('afterprint', () => {
  for (const details of folded()) details.open = Boolean(details.dataset.was);
});
for (const text of document.querySelectorAll('pre[data-copy]')) text.after(copyButton(() => text.textContent));
})();
