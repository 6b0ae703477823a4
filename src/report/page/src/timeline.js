// Play, pause, speed and the slider in time, above it the error of every frame and the worst periods.
import { h, svg, labelledSelect } from './dom.js';
import { seconds } from './format.js';

const SPEEDS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
const PLAYED_IN = 6;  // s, about how long the whole motion plays at the first speed

// The spans of times in which frames were held out; each reaches half-way to its neighbours.
export function heldOutSpans(times, fitted) {
  const spans = [];
  for (let k = 0; k < times.length; ++k) {
    if (fitted?.[k] !== false) continue;
    const from = k > 0 ? (times[k - 1] + times[k]) / 2 : times[k];
    const to = k + 1 < times.length ? (times[k] + times[k + 1]) / 2 : times[k];
    const last = spans[spans.length - 1];
    if (last && Math.abs(last[1] - from) < 1e-12) last[1] = to;
    else spans.push([from, to]);
  }
  return spans;
}

export class Timeline {
  constructor(store, onTime) {
    this.store = store;
    this.onTime = onTime;
    this.times = [];
    this.play = h('button', { type: 'button', class: 'play', 'aria-label': 'Play', onclick: () => this.toggle() }, '▶');
    this.slider = h('input', { type: 'range', min: 0, max: 1, step: 'any', value: 0, 'aria-label': 'Time',
      oninput: () => this.go(Number(this.slider.value)), onkeydown: (event) => this.press(event) });
    this.readout = h('output', { class: 'readout' });
    this.strip = svg('svg', { class: 'strip', preserveAspectRatio: 'none', 'aria-hidden': 'true' });
    const speed = labelledSelect('Speed', SPEEDS.map((one) => [String(one), `${one} ×`]), '1', (value) => { this.speed = Number(value); });
    this.speedSelect = speed.select;
    this.root = h('div', { class: 'timeline' }, this.play,
      h('div', { class: 'track' }, this.strip, this.slider), this.readout, speed.root);
  }

  setMotion(scene, worstPeriods) {
    this.times = scene?.times ?? [];
    this.fitted = scene?.fitted ?? [];
    this.root.hidden = this.times.length < 2;
    if (this.times.length < 2) return;
    const [first, last] = [this.times[0], this.times[this.times.length - 1]];
    this.slider.min = String(first);
    this.slider.max = String(last);
    if (this.motionLength !== last - first) {
      this.motionLength = last - first;
      const wanted = (last - first) / PLAYED_IN;
      this.speed = SPEEDS.reduce((best, one) => (Math.abs(Math.log(one / wanted)) < Math.abs(Math.log(best / wanted)) ? one : best));
      this.speedSelect.value = String(this.speed);
    }
    this.drawStrip(scene, worstPeriods, first, last);
  }

  drawStrip(scene, worstPeriods, first, last) {
    const x = (time) => (1000 * (time - first)) / (last - first || 1);
    const { series } = scene;
    const parts = [];
    for (const [from, to] of heldOutSpans(this.times, this.fitted)) {
      parts.push(svg('rect', { x: x(from), y: 0, width: Math.max(1, x(to) - x(from)), height: 30, class: 'strip-held-out' }));
    }
    for (const period of worstPeriods) {
      parts.push(svg('rect', { x: x(period.from), y: 27, width: Math.max(4, x(period.to) - x(period.from)), height: 3, class: 'strip-worst' }));
    }
    const rms = series?.rms_m ?? [];
    const largest = Math.max(...rms.filter(Number.isFinite), 0);
    if (largest > 0) {
      const line = rms.map((value, k) => (Number.isFinite(value) ? `${x(series.time_s[k]).toFixed(1)},${(26 - (24 * value) / largest).toFixed(1)}` : null)).filter(Boolean);
      parts.push(svg('polyline', { points: line.join(' '), class: 'strip-line' }));
    }
    this.strip.toggleAttribute('hidden', parts.length === 0);
    this.strip.setAttribute('viewBox', '0 0 1000 30');
    this.strip.replaceChildren(...parts);
  }

  nearest(time) {
    let best = 0;
    for (let k = 1; k < this.times.length; ++k) if (Math.abs(this.times[k] - time) < Math.abs(this.times[best] - time)) best = k;
    return best;
  }

  go(time) {
    this.onTime(time);
  }

  showTime(time) {
    if (this.times.length < 2) return;
    const frame = this.nearest(time);
    this.slider.value = String(time);
    const part = !this.fitted.includes(false) ? '' : this.fitted[frame] === false ? 'held out' : 'fitted';
    this.slider.setAttribute('aria-valuetext', `${seconds(this.times[frame])}, frame ${frame + 1} of ${this.times.length}${part ? `, ${part}` : ''}`);
    this.readout.replaceChildren(h('strong', {}, seconds(this.times[frame])),
      h('span', { class: 'muted' }, ` ${frame + 1}/${this.times.length}`), part ? h('span', { class: `part part-${part.replace(' ', '-')}` }, part) : '');
  }

  press(event) {
    const frame = this.nearest(Number(this.slider.value));
    const last = this.times.length - 1;
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    const target = event.key === 'Home' ? 0 : event.key === 'End' ? last : step === undefined ? null : frame + step;
    if (target === null) return;
    event.preventDefault();
    this.go(this.times[Math.min(Math.max(target, 0), last)]);
  }

  toggle() {
    this.isPlaying = !this.isPlaying;
    this.play.textContent = this.isPlaying ? '❚❚' : '▶';
    this.play.setAttribute('aria-label', this.isPlaying ? 'Pause' : 'Play');
    if (!this.isPlaying) return;
    const last = this.times[this.times.length - 1];
    let time = Number(this.slider.value);
    if (time >= last) time = this.times[0];
    let before = performance.now();
    const tick = (now) => {
      if (!this.isPlaying) return;
      time += ((now - before) / 1000) * this.speed;
      before = now;
      if (time > last) time = this.times[0];
      this.go(time);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
}
