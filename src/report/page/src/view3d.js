// One canvas with one or two panes that share the camera. It is drawn only when something changed.
import { ColorManagement, LinearSRGBColorSpace, Vector3, WebGLRenderer } from 'three';
import { themeColour, onThemeChange } from './colours.js';
import { OrbitCamera } from './orbit.js';
import { Pane } from './pane3d.js';
import { h, svg } from './dom.js';
import { KEYBOARD_HELP } from './text.js';
import { number } from './format.js';

// Colours are given as they appear on the screen.
ColorManagement.enabled = false;

const LARGEST_PIXEL_RATIO = 1.5;
const GAP = 2;
const STACKED_BELOW = 520;

export class View3d {
  constructor(onPick) {
    this.canvas = h('canvas', { tabindex: 0, role: 'application', 'aria-label': `3D view. ${KEYBOARD_HELP}`, class: 'view-canvas' });
    this.overlay = svg('svg', { class: 'view-overlay', 'aria-hidden': 'true' });
    this.labels = h('div', { class: 'view-labels' });
    this.copy = h('canvas', { class: 'view-print', 'aria-hidden': 'true' });
    this.root = h('div', { class: 'view' }, this.canvas, this.copy, this.overlay, this.labels);
    this.panes = [new Pane(), new Pane()];
    this.visiblePanes = 1;
    this.view = null;
    this.frames = [0, 0];
    this.selected = null;
    this.marked = [];
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, alpha: false, preserveDrawingBuffer: true });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.autoClear = false;
    this.orbit = new OrbitCamera(this.canvas, () => this.invalidate());
    this.listenForPicks(onPick);
    new ResizeObserver(() => this.invalidate()).observe(this.root);
    onThemeChange(() => { this.readTheme(); this.showFrames(this.frames); });
    this.readTheme();
  }

  readTheme() {
    this.theme = {
      background: themeColour('view'), surface: themeColour('view-surface'), measured: themeColour('view-measured'),
      model: themeColour('view-model'), arrow: themeColour('view-arrow'), scan: themeColour('view-scan'), outline: themeColour('view-outline'), edges: themeColour('view-edges'),
    };
  }

  // Shows data in the panes; `labels` are written above them.
  async setScenes(scenes, labels) {
    this.visiblePanes = scenes.length;
    await Promise.all(scenes.map((data, k) => this.panes[k].load(data)));
    this.labels.replaceChildren(...labels.map((label) =>
      h('span', { class: 'view-label' }, h('i', { class: 'swatch', style: { background: `var(--${label.colour})` } }), h('span', { class: 'clip', title: label.text.slice(0, 300) }, label.text))));
    this.labels.dataset.count = String(labels.length);
  }

  async setView(view) {
    this.view = { ...view, theme: this.theme };
    for (let k = 0; k < this.visiblePanes; ++k) {
      await this.panes[k].prepare(view.colouring);
      this.panes[k].showEdges(view.edges, this.theme.edges);
    }
  }

  showFrames(frames) {
    this.frames = frames;
    if (!this.view) return;
    this.view.theme = this.theme;
    for (let k = 0; k < this.visiblePanes; ++k) {
      if (this.panes[k].edges) this.panes[k].edges.material.color.set(this.theme.edges);
      this.panes[k].show(frames[k] ?? 0, this.view);
    }
    this.invalidate();
  }

  invalidate() {
    if (this.isScheduled) return;
    this.isScheduled = true;
    requestAnimationFrame(() => {
      this.isScheduled = false;
      this.render();
    });
  }

  // Draws the view and copies it to where browsers print it from: of a WebGL canvas they print what
  // was last on the screen.
  renderForPrint() {
    this.render();
    this.copy.width = this.canvas.width;
    this.copy.height = this.canvas.height;
    this.copy.getContext('2d').drawImage(this.canvas, 0, 0);
  }

  layout() {
    const width = Math.max(1, this.root.clientWidth), height = Math.max(1, this.root.clientHeight);
    const count = this.visiblePanes;
    const isStacked = count > 1 && width < STACKED_BELOW;
    this.labels.dataset.stacked = String(isStacked);
    if (count === 1) return { width, height, boxes: [{ x: 0, y: 0, width, height }] };
    const w = isStacked ? width : (width - GAP) / 2, tall = isStacked ? (height - GAP) / 2 : height;
    return { width, height, boxes: [0, 1].map((k) => ({ x: isStacked ? 0 : k * (w + GAP), y: isStacked ? k * (tall + GAP) : 0, width: w, height: tall })) };
  }

  render() {
    const { renderer, orbit } = this;
    const { width, height, boxes } = this.layout();
    const ratio = Math.min(devicePixelRatio || 1, LARGEST_PIXEL_RATIO);
    if (this.drawnWidth !== width || this.drawnHeight !== height || this.drawnRatio !== ratio) {
      renderer.setPixelRatio(ratio);
      renderer.setSize(width, height, false);
      [this.drawnWidth, this.drawnHeight, this.drawnRatio] = [width, height, ratio];
    }
    orbit.setAspect(boxes[0].width / boxes[0].height);
    orbit.place();
    renderer.setScissorTest(false);
    renderer.setClearColor(themeColour('rule'), 1);
    renderer.clear();
    renderer.setScissorTest(true);
    renderer.setClearColor(this.theme.background, 1);
    boxes.forEach((box, k) => {
      const bottom = height - box.y - box.height;
      renderer.setViewport(box.x, bottom, box.width, box.height);
      renderer.setScissor(box.x, bottom, box.width, box.height);
      renderer.clear();
      const { arrows } = this.panes[k];
      if (arrows) arrows.material.uniforms.resolution.value.set(box.width, box.height);
      for (const points of [this.panes[k].measured, this.panes[k].model]) {
        if (!points) continue;
        points.userData.size ??= points.material.uniforms.size.value;
        points.material.uniforms.size.value = points.userData.size * ratio;
      }
      renderer.render(this.panes[k].scene, orbit.camera);
    });
    this.boxes = boxes;
    this.drawOverlay();
  }

  // Where a place of the model appears in a pane, in CSS pixels.
  project(place, box) {
    const at = new Vector3(...place).project(this.orbit.camera);
    return { x: box.x + ((at.x + 1) / 2) * box.width, y: box.y + ((1 - at.y) / 2) * box.height, depth: at.z };
  }

  // The axes, a scale bar, the worst points and the selected one.
  drawOverlay() {
    const { camera, distance } = this.orbit;
    const box = this.boxes[0];
    const parts = [];
    const corner = { x: 30, y: box.y + box.height - 30 };
    const { elements } = camera.matrixWorldInverse;
    for (let k = 0; k < 3; ++k) {
      const [x, y] = [elements[4 * k], elements[4 * k + 1]];
      parts.push(svg('line', { x1: corner.x, y1: corner.y, x2: corner.x + 18 * x, y2: corner.y - 18 * y, class: 'axis' }),
        svg('text', { x: corner.x + 25 * x, y: corner.y - 25 * y + 3.5, 'text-anchor': 'middle' }, 'xyz'[k]));
    }
    const perPixel = (2 * distance * Math.tan((camera.fov * Math.PI) / 360)) / box.height;
    const power = 10 ** Math.floor(Math.log10(90 * perPixel));
    const length = [5, 2, 1].map((m) => m * power).find((one) => one <= 90 * perPixel) ?? power;
    const [right, bottom] = [box.x + box.width - 16, box.y + box.height - 16];
    parts.push(svg('path', { d: `M${right - length / perPixel} ${bottom - 4}V${bottom}H${right}V${bottom - 4}`, class: 'scale-bar' }),
      svg('text', { x: right - length / perPixel / 2, y: bottom - 6, 'text-anchor': 'middle' }, `${number(1e3 * length, 1)} mm`));
    for (const point of this.marked) {
      const place = point === this.selected ? null : this.placeOfPoint(0, point);
      if (!place) continue;
      const at = this.project(place, this.boxes[0]);
      parts.push(svg('circle', { cx: at.x, cy: at.y, r: 11, class: 'worst-mark' }));
    }
    if (this.selected !== null) {
      for (let k = 0; k < this.visiblePanes; ++k) {
        const place = this.placeOfPoint(k, this.selected);
        if (!place) continue;
        const at = this.project(place, this.boxes[k]);
        const isRight = at.x > this.boxes[k].x + this.boxes[k].width - 70;
        parts.push(svg('circle', { cx: at.x, cy: at.y, r: 11, class: 'selected-point' }),
          svg('text', { x: at.x + (isRight ? -15 : 15), y: at.y - 9, 'text-anchor': isRight ? 'end' : 'start', class: 'selected-name' }, this.panes[k].data.pointName(this.selected).slice(0, 24)));
      }
    }
    this.overlay.replaceChildren(...parts);
  }

  placeOfPoint(pane, point, frame = this.frames[pane] ?? 0) {
    const data = this.panes[pane].data;
    for (const array of [data?.measured, data?.model]) {
      if (!array || point >= array.shape[1]) continue;
      const place = [...array.frame(Math.min(frame, array.frames - 1)).subarray(3 * point, 3 * point + 3)];
      if (place.every((value) => !Number.isNaN(value))) return place;
    }
    return null;
  }

  listenForPicks(onPick) {
    let start = null;
    this.canvas.addEventListener('pointerdown', (event) => { start = { x: event.clientX, y: event.clientY }; });
    this.canvas.addEventListener('pointerup', (event) => {
      if (!start || Math.hypot(event.clientX - start.x, event.clientY - start.y) > 4) return;
      const bounds = this.canvas.getBoundingClientRect();
      const point = this.pointAt(event.clientX - bounds.left, event.clientY - bounds.top);
      if (point !== null) onPick(point);
    });
  }

  // The point nearest to a place on the canvas, or null where none is near.
  pointAt(x, y) {
    const pane = this.boxes?.findIndex((box) => x >= box.x && x < box.x + box.width && y >= box.y && y < box.y + box.height) ?? -1;
    const data = pane >= 0 ? this.panes[pane].data : null;
    if (!data || data.pointCount === 0) return null;
    let best = null, least = 16;
    for (const array of [data.measured, data.model]) {
      if (!array) continue;
      const places = array.frame(Math.min(this.frames[pane] ?? 0, array.frames - 1));
      for (let k = 0; k < data.pointCount; ++k) {
        if (Number.isNaN(places[3 * k])) continue;
        const at = this.project(places.subarray(3 * k, 3 * k + 3), this.boxes[pane]);
        const gap = Math.hypot(at.x - x, at.y - y);
        if (gap < least) [best, least] = [k, gap];
      }
    }
    return best;
  }

  // The time that a step to other frames takes until its pixels exist, ms.
  measureStep(frames) {
    const start = performance.now();
    this.showFrames(frames);
    this.render();
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    return performance.now() - start;
  }
}
