// Line charts in the colours of the theme, with shaded spans and a table of their numbers. A chart
// is drawn when it comes near the visible part of the page, or before printing.
import uPlot from 'uplot';
import { onThemeChange, themeColour } from './colours.js';
import { h } from './dom.js';
import { number } from './format.js';

const MOST_ROWS = 400;
const live = new Set();
const waiting = new Map();

const observer = new IntersectionObserver((entries) => {
  for (const entry of entries) if (entry.isIntersecting) start(entry.target);
}, { rootMargin: '500px' });

function start(element) {
  const draw = waiting.get(element);
  if (!draw) return;
  waiting.delete(element);
  observer.unobserve(element);
  draw();
}

// Printing changes the theme and the width: see print.js.
export function drawAllCharts() {
  for (const element of [...waiting.keys()]) start(element);
  for (const chart of [...live]) chart.resize();
}
onThemeChange(() => {
  for (const chart of live) chart.recolour();
});

const FONT = '12px system-ui, sans-serif';

function axis(label, isVertical, size) {
  return {
    label, labelSize: 20, labelFont: FONT, font: FONT, labelGap: 0, size: isVertical ? (plot, labels) => Math.max(size, 14 + 7 * Math.max(0, ...(labels ?? []).map((text) => text.length))) : 34, gap: 4,
    space: isVertical ? 36 : (plot, _, low, high, length) => (length < 420 ? 52 : 80),
    stroke: () => themeColour('muted'), grid: { stroke: () => themeColour('faint'), width: 1 }, ticks: { stroke: () => themeColour('rule'), width: 1, size: 4 },
    values: (_, splits) => splits.map((value) => (value === null ? '' : String(Number(value.toPrecision(6))).replace('-', '−'))),
  };
}

function seriesOptions(one) {
  const colour = () => themeColour(one.colour);
  const isDots = one.style === 'dots';
  return {
    label: one.label, stroke: colour, width: isDots ? 0 : one.width ?? 1.8, dash: one.dash ? [5, 4] : undefined, spanGaps: false,
    paths: isDots || one.inOrder ? () => null : undefined,
    points: one.inOrder ? { show: false } : isDots || one.style === 'line-dots' ? { show: true, size: one.size ?? 5, fill: colour, stroke: colour, width: 0 } : { show: false },
    value: (_, value) => (value === null || value === undefined ? '' : number(value)),
  };
}

// Paints the shaded spans and the horizontal lines, below the data.
function underlay(options) {
  return (plot) => {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (const [from, to] of options.spans ?? []) {
      const [a, b] = [from, to].map((value) => plot.valToPos(value, 'x', true));
      ctx.fillStyle = themeColour('held-out');
      ctx.fillRect(a, bbox.top, Math.max(1, b - a), bbox.height);
    }
    for (const band of options.bands ?? []) {
      const [top, bottom] = [band.to, band.from].map((value) => plot.valToPos(value, 'y', true));
      ctx.globalAlpha = 0.16;
      ctx.fillStyle = themeColour(band.colour ?? 'noise');
      ctx.fillRect(bbox.left, top, bbox.width, bottom - top);
      ctx.globalAlpha = 1;
    }
    for (const line of options.lines ?? []) {
      ctx.strokeStyle = themeColour(line.colour ?? 'noise');
      ctx.lineWidth = 1.5 * devicePixelRatio;
      ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
      ctx.beginPath();
      if (line.y !== undefined) {
        const y = plot.valToPos(line.y, 'y', true);
        ctx.moveTo(bbox.left, y);
        ctx.lineTo(bbox.left + bbox.width, y);
      } else {
        const x = plot.valToPos(line.x, 'x', true);
        ctx.moveTo(x, bbox.top);
        ctx.lineTo(x, bbox.top + bbox.height);
      }
      ctx.stroke();
      ctx.setLineDash([]);
    }
    ctx.restore();
  };
}

// Areas between two arrays of values, such as uncertainty bands.
function drawAreas(options) {
  return (plot) => {
    const { ctx } = plot;
    for (const area of options.areas ?? []) {
      if (area.x.length < 2) continue;
      ctx.save();
      ctx.beginPath();
      ctx.rect(plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height);
      ctx.clip();
      ctx.globalAlpha = 0.18;
      ctx.fillStyle = themeColour(area.colour);
      ctx.beginPath();
      area.x.forEach((x, k) => ctx[k ? 'lineTo' : 'moveTo'](plot.valToPos(x, 'x', true), plot.valToPos(area.low[k], 'y', true)));
      for (let k = area.x.length - 1; k >= 0; --k) ctx.lineTo(plot.valToPos(area.x[k], 'x', true), plot.valToPos(area.high[k], 'y', true));
      ctx.fill();
      ctx.restore();
    }
  };
}

// Draws the series that go back and forth along x, which the library sorts, in the order of their values.
function drawInOrder(options) {
  return (plot) => {
    const { ctx, bbox } = plot;
    for (const one of options.series) {
      if (!one.inOrder) continue;
      ctx.save();
      ctx.beginPath();
      ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
      ctx.clip();
      ctx.strokeStyle = ctx.fillStyle = themeColour(one.colour);
      ctx.lineWidth = (one.style === 'dots' ? 1.2 : 1.8) * devicePixelRatio;
      if (one.dash && one.style !== 'dots') ctx.setLineDash([5 * devicePixelRatio, 4 * devicePixelRatio]);
      let isOpen = false;
      ctx.beginPath();
      for (let k = 0; k < one.x.length; ++k) {
        const isKnown = Number.isFinite(one.x[k]) && Number.isFinite(one.y[k]);
        const [x, y] = isKnown ? [plot.valToPos(one.x[k], 'x', true), plot.valToPos(one.y[k], 'y', true)] : [];
        if (isKnown && one.style === 'dots') {
          const radius = ((one.size ?? 5) / 2) * devicePixelRatio;
          ctx.moveTo(x + radius, y);
          ctx.arc(x, y, radius, 0, 2 * Math.PI);
        } else if (isKnown) {
          ctx[isOpen ? 'lineTo' : 'moveTo'](x, y);
        }
        isOpen = isKnown;
      }
      if (one.style === 'dots' && !one.hollow) ctx.fill();
      else ctx.stroke();
      ctx.restore();
    }
  };
}

function rangeOf(fixed, includesZero, marginShare = 0.06) {
  return (_, low, high) => {
    if (low === null || high === null) return [0, 1];
    const a = fixed?.[0] ?? (includesZero ? Math.min(low, 0) : low);
    const b = fixed?.[1] ?? (includesZero ? Math.max(high, 0) : high);
    if (!(b > a)) return [a - (Math.abs(a) || 1) * 0.5, b + (Math.abs(b) || 1) * 0.5];
    const margin = (b - a) * marginShare;
    return [fixed?.[0] !== undefined || (includesZero && low >= 0) ? a : a - margin, fixed?.[1] ?? b + margin];
  };
}

class Chart {
  constructor(host, options, data) {
    this.host = host;
    this.options = options;
    const draw = [underlay(options), drawAreas(options)];
    this.plot = new uPlot({
      width: Math.max(200, host.clientWidth), height: options.height ?? 240, scales: {
        x: { time: false, range: rangeOf(options.xRange, false, options.series.every((one) => one.style === undefined) ? 0.004 : 0.025) },
        y: { range: rangeOf(options.yRange, options.includesZero ?? true) },
      },
      axes: [axis(options.x, false), axis(options.y, true, options.axisSize ?? 52)],
      series: [{ label: options.x, value: (_, value) => (value === null || value === undefined ? '' : number(value)) }, ...options.series.map(seriesOptions)],
      hooks: { drawClear: draw, draw: [drawInOrder(options)], ready: [(plot) => this.addMarker(plot)], setSize: [() => this.showTime()] },
      cursor: { y: false, points: { size: 7 }, drag: { x: true, y: false } },
      legend: { show: options.legend ?? true, live: true, markers: { width: 0, fill: (_, k) => themeColour(options.series[k - 1]?.colour ?? 'muted') } },
    }, data, host);
    new ResizeObserver(() => this.resize()).observe(host);
    live.add(this);
  }

  addMarker(plot) {
    const { store } = this.options;
    if (!store) return;
    this.marker = h('div', { class: 'time-marker' });
    plot.over.append(this.marker);
    plot.over.addEventListener('click', (event) => {
      const bounds = plot.over.getBoundingClientRect();
      store.set({ time: plot.posToVal(event.clientX - bounds.left, 'x') });
    });
    this.unsubscribe = store.on(['time'], () => this.showTime());
    queueMicrotask(() => this.showTime());
  }

  showTime() {
    if (!this.marker || !this.plot) return;
    if (!this.host.isConnected) {
      this.end();
      return;
    }
    const { time } = this.options.store.get();
    this.marker.hidden = time === null;
    if (time !== null) this.marker.style.setProperty('transform', `translateX(${this.plot.valToPos(time, 'x')}px)`);
  }

  recolour() {
    this.plot.redraw(false, true);
    this.host.querySelectorAll('.u-legend .u-series').forEach((row, k) => {
      const marker = row.querySelector('.u-marker');
      if (marker && k > 0) marker.style.background = themeColour(this.options.series[k - 1].colour);
    });
  }

  // A chart whose figure was taken off the page.
  end() {
    if (!live.delete(this)) return;
    this.unsubscribe?.();
    this.plot.destroy();
  }

  resize() {
    if (!this.host.isConnected) {
      this.end();
      return;
    }
    const width = this.host.clientWidth;
    if (width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.options.height ?? 240 });
  }
}

// Joins series with times of their own into one table, as the library needs it.
function joined(series) {
  const clean = (values) => Array.from(values, (value) => (Number.isFinite(value) ? value : null));
  const sorted = (one) => {
    const order = Array.from(one.x, (_, k) => k).filter((k) => Number.isFinite(one.x[k])).sort((a, b) => one.x[a] - one.x[b]);
    return [order.map((k) => one.x[k]), clean(order.map((k) => one.y[k]))];
  };
  const tables = series.map(sorted);
  const isShared = tables.every((table) => table[0].length === tables[0][0].length && table[0].every((x, k) => x === tables[0][0][k]));
  return isShared ? [tables[0][0], ...tables.map((table) => table[1])] : uPlot.join(tables);
}

function numbersTable(options, data) {
  const every = Math.max(1, Math.ceil(data[0].length / MOST_ROWS));
  const rows = data[0].map((_, k) => k).filter((k) => k % every === 0);
  return h('div', { class: 'table-box' }, h('table', {},
    h('thead', {}, h('tr', {}, [options.x, ...options.series.map((one) => one.label)].map((label) => h('th', { scope: 'col' }, label)))),
    h('tbody', {}, rows.map((k) => h('tr', {}, data.map((column, c) => h(c === 0 ? 'th' : 'td', c === 0 ? { scope: 'row' } : {}, number(column[k] ?? NaN, 4))))))),
  every > 1 ? h('p', { class: 'explain' }, `Every ${every}th row.`) : null);
}

// One legend for several charts with the same series.
export function sharedLegend(series) {
  return h('p', { class: 'key', 'aria-hidden': 'true' }, series.map((one) => h('span', { class: 'key-item' },
    h('i', { class: `key-line${one.dash ? ' dashed' : ''}${one.style === 'dots' ? ' dots' : ''}${one.hollow ? ' hollow' : ''}`, style: { 'border-color': `var(--${one.colour})` } }), one.label.slice(0, 120))));
}

// A figure with a chart. `options.series` are {label, x, y, colour, style, dash, inOrder, hollow}; an empty
// chart is null.
export function chart(options) {
  const series = options.series.filter((one) => one.x?.length > 0 && Array.from(one.y ?? []).some(Number.isFinite));
  if (series.length === 0) return null;
  const used = { ...options, series };
  const host = h('div', { class: 'chart', role: 'img', 'aria-label': `${options.title}: ${series.map((one) => one.label).join(', ')} against ${options.x}` });
  const numbers = h('details', { class: 'numbers' }, h('summary', {}, 'Numbers'));
  numbers.addEventListener('toggle', () => {
    if (numbers.open && numbers.childElementCount === 1) numbers.append(numbersTable(used, joined(series)));
  });
  waiting.set(host, () => new Chart(host, used, joined(series)));
  observer.observe(host);
  return h('figure', { class: 'plot' },
    h('figcaption', {}, h('h3', {}, options.title), options.explain ? h('p', { class: 'explain' }, options.explain) : null),
    host, numbers);
}
