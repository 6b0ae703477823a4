// The arrays of one recording of one model, and the quantities that can colour it.
import { unpack } from './decode.js';
import { displayUnit, isNumber } from './format.js';

const USUAL_SHARE = 0.995;  // of the values that the colour scale distinguishes
const CUT_BELOW = 0.9;      // share of the full range above which the scale is not shortened
const MOST_SAMPLES = 100000;

const loaded = new WeakMap();

// Evenly spread values of an array of frames, without those that were not observed.
function sampleOf(array) {
  const every = Math.max(1, Math.floor((array.frames * array.stride) / MOST_SAMPLES));
  const values = [];
  let next = 0;
  for (let f = 0; f < array.frames; ++f) {
    if (next >= array.stride) {
      next -= array.stride;
      continue;
    }
    const frame = array.frame(f);
    for (; next < array.stride; next += every) if (!Number.isNaN(frame[next])) values.push(frame[next]);
    next -= array.stride;
  }
  return Float32Array.from(values);
}

export function loadScene(scene) {
  if (!loaded.has(scene)) loaded.set(scene, loadNow(scene));
  return loaded.get(scene);
}

async function loadNow(scene) {
  const { surface, points } = scene;
  const [triangles, positions, measured, model, residual, sigmas] = await Promise.all([
    unpack(surface?.triangles), unpack(surface?.positions), unpack(points?.measured), unpack(points?.model),
    unpack(points?.residual), unpack(points?.sigmas)]);
  return new SceneData(scene, { triangles, positions, measured, model, residual, sigmas });
}

// The rms length that noise of standard deviation σ per component gives to a point.
export const rmsOfNoise = (sigma, isScan) => (isNumber(sigma) && sigma > 0 ? (isScan ? 1 : Math.sqrt(3)) * sigma : null);

export class SceneData {
  constructor(scene, arrays) {
    Object.assign(this, arrays);
    this.scene = scene;
    this.times = scene.times ?? [];
    this.up = scene.up ?? null;
    this.pointCount = this.measured?.shape[1] ?? this.model?.shape[1] ?? 0;
    this.triangleCount = this.triangles ? this.triangles.shape[0] : 0;
    this.indices = this.triangles ? new Uint32Array(this.triangles.values) : null;
    this.fieldRanges = new Map();
    this.residualScales = new Map();
  }

  // Finds the range of a field that is drawn: without its most extreme values, which would make all
  // others look alike.
  async measureField(colouring) {
    const field = colouring.name && fieldOf(this.scene, colouring);
    if (!field || this.fieldRanges.has(colouring.name)) return;
    const values = sampleOf(await unpack(field.values));
    const [low, high] = [field.low ?? 0, field.high ?? 1];
    const size = Math.max(Math.abs(low), Math.abs(high));
    const sorted = values.map(Math.abs).sort();
    const most = sorted.length > 0 ? sorted[Math.floor(USUAL_SHARE * (sorted.length - 1))] : size;
    const limit = most > 0 && most < CUT_BELOW * size ? most : size;
    this.fieldRanges.set(colouring.name, { low: Math.max(low, -limit), high: Math.min(high, limit), isCut: limit < size });
  }

  frameAt(time) {
    const { times } = this;
    let best = 0;
    for (let k = 1; k < times.length; ++k) if (Math.abs(times[k] - time) < Math.abs(times[best] - time)) best = k;
    return best;
  }

  pointName(index) { return this.scene.points?.names?.[index] ?? String(index); }

  // The length of the residual of each point in m, NaN where it was not observed.
  residualLengths(frame) {
    const lengths = new Float32Array(this.pointCount).fill(NaN);
    if (this.residual) {
      const values = this.residual.frame(frame);
      const size = this.residual.stride / this.pointCount;
      for (let k = 0; k < this.pointCount; ++k) {
        lengths[k] = size === 1 ? Math.abs(values[k]) : Math.hypot(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
      }
    } else if (this.measured && this.model) {
      const [a, b] = [this.measured.frame(frame), this.model.frame(frame)];
      for (let k = 0; k < this.pointCount; ++k) {
        lengths[k] = Math.hypot(b[3 * k] - a[3 * k], b[3 * k + 1] - a[3 * k + 1], b[3 * k + 2] - a[3 * k + 2]);
      }
    }
    return lengths;
  }

  // The same over the rms length that noise alone gives to the point: that of its own σ in this frame, if it has one.
  residualsOverNoise(frame) {
    const { sigma, is_scan: isScan } = this.scene.points ?? {};
    const own = this.sigmas?.frame(frame);
    return this.residualLengths(frame).map((length, k) => length / (rmsOfNoise(own ? own[k] : sigma, isScan) ?? NaN));
  }

  // The residuals that a colouring of points shows.
  residuals(frame, isOverNoise) { return isOverNoise ? this.residualsOverNoise(frame) : this.residualLengths(frame); }

  // Almost the largest residual of all frames, in m or over the noise: single outliers would make all else look alike.
  residualScale(isOverNoise = false) {
    if (!this.residualScales.has(isOverNoise)) {
      const all = [];
      const every = Math.max(1, Math.floor((this.times.length * this.pointCount) / 200000));
      for (let frame = 0; frame < this.times.length; frame += every) {
        for (const value of this.residuals(frame, isOverNoise)) if (value >= 0) all.push(value);
      }
      all.sort((a, b) => a - b);
      const usual = all[Math.min(all.length - 1, Math.floor(USUAL_SHARE * all.length))] ?? 0;
      this.residualScales.set(isOverNoise, { usual, isCut: usual < (all.at(-1) ?? 0) });
    }
    return this.residualScales.get(isOverNoise);
  }

  // Normals of some triangles in the first frame, as long as twice the area of each.
  normals() {
    if (!this.positions) return [];
    const places = this.positions.frame(0), { indices } = this, normals = [];
    const every = 3 * Math.max(1, Math.floor(this.triangleCount / 2000));
    for (let t = 0; t + 2 < indices.length; t += every) {
      const [a, b, c] = [0, 1, 2].map((k) => places.subarray(3 * indices[t + k], 3 * indices[t + k] + 3));
      const [u, v] = [b, c].map((one) => [0, 1, 2].map((k) => one[k] - a[k]));
      normals.push(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    }
    return normals;
  }

  // Centre and radius of everything that is drawn.
  bounds() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const array of [this.positions, this.measured, this.model]) {
      if (!array) continue;
      const every = Math.max(1, Math.floor(array.frames / 12));
      for (let frame = 0; frame < array.frames; frame += every) {
        const values = array.frame(frame);
        for (let k = 0; k < values.length; ++k) {
          if (values[k] < low[k % 3]) low[k % 3] = values[k];
          if (values[k] > high[k % 3]) high[k % 3] = values[k];
        }
      }
    }
    if (!(low[0] <= high[0])) return { centre: [0, 0, 0], radius: 1, low: [0, 0, 0], high: [0, 0, 0] };
    const centre = low.map((value, k) => (value + high[k]) / 2);
    return { centre, radius: Math.hypot(...low.map((value, k) => high[k] - value)) / 2 || 1, low, high };
  }
}

// What can colour the view: residuals of the points, and the fields of the surface. Each has a key,
// a label, a unit and a factor from the stored to the shown value.
export function colourings(scenes) {
  const list = [];
  const points = scenes.some((scene) => scene?.points && (scene.points.residual || (scene.points.measured && scene.points.model)));
  if (points) {
    const largest = Math.max(...scenes.map((scene) => (scene?.series?.rms_m ?? []).reduce((most, value) => Math.max(most, value ?? 0), 0)));
    const shown = largest > 0 && largest < 1e-5 ? { unit: 'µm', factor: 1e6 } : { unit: 'mm', factor: 1e3 };
    list.push({ key: 'residual', label: 'residual', ...shown, diverging: false, ofPoints: true });
    if (scenes.some((scene) => rmsOfNoise(scene?.points?.sigma, scene?.points?.is_scan))) {
      const unit = scenes.some((scene) => scene?.points?.sigmas) ? 'times the noise of each point' : 'times the noise';
      list.push({ key: 'residual_sigma', label: 'residual', unit, factor: 1, diverging: false, ofPoints: true, isOverNoise: true });
    }
  }
  for (const scene of scenes) {
    for (const field of scene?.surface?.fields ?? []) {
      const key = `field:${field.name}`;
      if (list.some((one) => one.key === key)) continue;
      const size = Math.max(Math.abs(field.low ?? 0), Math.abs(field.high ?? 0));
      const isStrain = field.unit === '' && /strain/.test(field.name);
      const shown = isStrain ? { unit: '%', factor: 100 } : displayUnit(field.unit, size);
      list.push({ key, label: field.label || field.name, unit: shown.unit, factor: shown.factor,
                  diverging: Boolean(field.diverging), ofPoints: false, name: field.name });
    }
  }
  list.push({ key: 'none', label: 'nothing', unit: '', factor: 1, diverging: false, ofPoints: false });
  return list;
}

export const fieldOf = (scene, colouring) => scene?.surface?.fields?.find((field) => field.name === colouring.name);
