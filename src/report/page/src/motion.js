// The 3D view with its controls: what is shown, how it is coloured, when, and where it is worst.
import { h, labelledSelect, segmented } from './dom.js';
import { colourGradient, modelColourName } from './colours.js';
import { colourings, fieldOf, loadScene } from './scene_data.js';
import { number, NONE } from './format.js';
import { Timeline } from './timeline.js';
import { View3d } from './view3d.js';
import { worstPlaces } from './worst.js';
import { KEYBOARD_HELP } from './text.js';

const ARROW_SCALES = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
const LARGEST_WITH_EDGES = 6000;  // triangles whose edges are shown without being asked for

export const sceneOf = (choice, recording) => choice?.model.scenes?.find((scene) => scene.recording === recording) ?? null;

function explain(scenes) {
  const has = (key) => scenes.some((data) => data?.[key]);
  const parts = [];
  if (has('measured') && has('model')) parts.push(`Filled dots are measured, rings${has('positions') ? ' and the surface' : ''} are predicted.`);
  else if (has('measured') && has('positions')) parts.push('Red dots are measured, the surface is the model.');
  else if (has('positions')) parts.push('The surface is the model.');
  parts.push('Drag to turn', has('model') && has('measured') ? '; click a dot to plot it below.' : '.');
  return parts.join(' ').replace(' ;', ';').replace(' .', '.');
}

export class Motion {
  // `choices` are the models of all runs, with labels; `recordings` the names that they have.
  constructor(store, choices, recordings) {
    this.store = store;
    this.choices = choices;
    this.arrowScale = 1;
    this.edges = null;
    this.view = new View3d((point) => store.set({ point }));
    this.timeline = new Timeline(store, (time) => store.set({ time }));
    this.scale = h('div', { class: 'scale', role: 'img' });
    this.worst = h('div', { class: 'worst' });
    this.explanation = h('p', { class: 'explain' });
    this.controls = this.makeControls(recordings);
    this.notice = h('p', { class: 'notice', role: 'status', hidden: true });
    this.note = h('p', { class: 'explain', hidden: true });
    this.root = h('div', { class: 'motion' }, this.chooser, this.view.root, this.notice, this.note, this.scale, this.timeline.root, this.controls);
    store.on(['recording', 'first', 'second', 'isCompared'], () => this.reload());
    store.on(['mode', 'colouring'], () => this.restyle());
    store.on(['time'], () => this.showTime());
    store.on(['point'], (state) => { this.view.selected = state.point; this.view.invalidate(); });
  }

  makeControls(recordings) {
    const { store, choices } = this;
    const state = store.get();
    const top = [];
    if (recordings.length > 1) {
      this.recordingSelect = labelledSelect('Recording', recordings.map((name) => [name, name.slice(0, 80)]), state.recording, (recording) => store.set({ recording }));
      top.push(this.recordingSelect.root);
    }
    if (choices.length > 1) {
      const options = choices.map((choice, k) => [String(k), choice.label.slice(0, 80)]);
      const first = labelledSelect('Left', options, String(state.first), (value) => store.set({ first: Number(value) }));
      const second = labelledSelect('Right', options, String(state.second), (value) => store.set({ second: Number(value) }));
      this.compare = h('button', { type: 'button', 'aria-pressed': String(state.isCompared), class: 'toggle',
        onclick: () => store.set({ isCompared: !store.get().isCompared }) }, 'Side by side');
      top.push(first.root, second.root, this.compare);
      this.firstLabel = first.root.querySelector('label');
      this.secondControl = second.root;
    }
    this.chooser = h('div', { class: 'controls chooser', role: 'group', 'aria-label': 'What is compared' }, top);
    this.chooser.hidden = top.length === 0;
    this.mode = segmented('Show', [['both', 'both'], ['measured', 'measured'], ['model', 'model'], ['difference', 'difference']], state.mode, (mode) => store.set({ mode }));
    this.colour = labelledSelect('Colour', [['none', 'nothing']], 'none', (colouring) => store.set({ colouring }));
    this.arrows = labelledSelect('Arrows', ARROW_SCALES.map((factor) => [String(factor), `${factor} ×`]), '1', (value) => {
      this.arrowScale = Number(value);
      this.restyle();
    });
    this.edgesButton = h('button', { type: 'button', class: 'toggle', 'aria-pressed': 'false', onclick: () => {
      this.edges = !this.edges;
      this.restyle();
    } }, 'Mesh');
    this.all = h('button', { type: 'button', class: 'toggle', title: KEYBOARD_HELP, onclick: () => this.view.orbit.showAll() }, 'Reset view');
    return h('div', { class: 'controls', role: 'group', 'aria-label': 'Display' },
      this.mode.root, this.colour.root, this.arrows.root, this.edgesButton, this.all);
  }

  // The largest factor with which no arrow is longer than about a quarter of the object.
  chooseArrowScale(scenes, radius) {
    const largest = Math.max(...scenes.map((data) => (data?.pointCount > 0 ? data.residualScale().usual : 0)));
    this.arrowScale = ARROW_SCALES.findLast((factor) => factor * largest <= radius / 2) ?? 1;
    this.arrows.select.value = String(this.arrowScale);
  }

  shownChoices() {
    const { first, second, isCompared } = this.store.get();
    return isCompared && this.choices.length > 1 ? [this.choices[first], this.choices[second]] : [this.choices[first]];
  }

  // Loads the scenes of the chosen models and recording.
  async reload() {
    const state = this.store.get();
    const token = (this.loading = {});
    const shown = this.shownChoices();
    const scenes = shown.map((choice) => sceneOf(choice, state.recording));
    try {
      const data = await Promise.all(scenes.map((scene) => (scene ? loadScene(scene) : null)));
      if (token !== this.loading) return;
      this.data = data;
      await this.view.setScenes(data, shown.map((choice) => ({ text: choice.label, colour: choice.colour })));
      const main = data.find(Boolean);
      if (main && (this.homeOf !== main.scene.recording)) {
        this.homeOf = main.scene.recording;
        this.view.orbit.setHome({ ...main.bounds(), normals: main.normals() }, main.up);
        this.chooseArrowScale(data, main.bounds().radius);
        this.edges = main.triangleCount > 0 && main.triangleCount <= LARGEST_WITH_EDGES;
      }
      this.edgesButton.hidden = !main?.triangleCount;
      const notes = [...new Set(scenes.flatMap((scene) => scene?.notes ?? []))];
      this.note.hidden = notes.length === 0;
      this.note.textContent = notes.join(' ').slice(0, 600);
      const withPoints = data.some((one) => one?.pointCount > 0);
      this.mode.root.hidden = !withPoints;
      this.hasArrows = data.some((one) => one?.measured && one?.model);
      this.explanation.textContent = explain(data);
      const hasModel = data.some((one) => one?.model || one?.positions);
      for (const button of this.mode.root.children) {
        const { value } = button.dataset;
        button.hidden = (value === 'difference' && !this.hasArrows) || (['both', 'model'].includes(value) && !hasModel);
      }
      if (!this.hasArrows && state.mode === 'difference') this.store.set({ mode: 'both' });
      if (this.compare) {
        this.compare.setAttribute('aria-pressed', String(state.isCompared));
        this.secondControl.hidden = !state.isCompared;
        this.firstLabel.textContent = state.isCompared ? 'Left' : 'Model';
      }
      this.offerColourings(scenes);
      const items = this.listWorst(shown, scenes, data);
      this.timeline.setMotion(scenes.find(Boolean), items.filter((item) => item.from !== undefined));
      await this.restyle();
      const times = main?.times ?? [];
      if (state.time === null || state.time < times[0] || state.time > times[times.length - 1]) this.store.set({ time: this.firstTime(main, items) });
      else this.showTime();
    } catch (error) {
      this.notice.hidden = false;
      this.notice.textContent = error.message;
      console.warn(error.message);
    }
  }

  // The first time shown is that of the largest error, where before and after differ most; of a
  // reconstruction, the end.
  firstTime(data, items) {
    const largest = items.filter((item) => item.time !== null && item.point !== undefined).sort((a, b) => b.value - a.value)[0];
    return largest?.time ?? data?.times.at(-1) ?? 0;
  }

  offerColourings(scenes) {
    this.colourings = colourings(scenes);
    const { select, root } = this.colour;
    select.replaceChildren(...this.colourings.map((one) => h('option', { value: one.key }, `${one.label.slice(0, 60)}${one.unit ? ` (${one.unit})` : ''}`)));
    const wanted = this.store.get().colouring;
    const kept = this.colourings.find((one) => one.key === wanted) ?? this.colourings[0];
    select.value = kept.key;
    this.store.set({ colouring: kept.key });
    root.hidden = this.colourings.length < 2;
  }

  // The range of the colour scale, shared by all panes and by measured, model and difference.
  rangeOf(colouring) {
    if (colouring.key === 'none') return { low: 0, high: 1 };
    let low = Infinity, high = -Infinity, isCut = false;
    for (const data of this.data) {
      if (!data) continue;
      if (colouring.ofPoints) {
        const scale = data.residualScale(colouring.isOverNoise);
        low = 0;
        high = Math.max(high, scale.usual);
        isCut ||= scale.isCut;
      } else {
        const range = data.fieldRanges.get(colouring.name);
        if (!range) continue;
        low = Math.min(low, range.low);
        high = Math.max(high, range.high);
        isCut ||= range.isCut;
      }
    }
    if (!colouring.diverging && low > 0 && low < 0.3 * high) low = 0;
    if (!(low < high)) return { low: Number.isFinite(low) ? low : 0, high: (Number.isFinite(low) ? low : 0) + 1 };
    if (colouring.diverging) {
      const size = Math.max(Math.abs(low), Math.abs(high));
      return { low: -size, high: size, isCut };
    }
    return { low, high, isCut };
  }

  async restyle() {
    if (!this.data) return;
    const state = this.store.get();
    const token = (this.styling = {});
    const colouring = this.colourings.find((one) => one.key === state.colouring) ?? this.colourings[0];
    await Promise.all(this.data.map((one) => one?.measureField(colouring)));
    if (token !== this.styling) return;
    const range = this.rangeOf(colouring);
    this.mode.set(state.mode, false);
    this.colour.select.value = colouring.key;
    this.arrows.root.hidden = state.mode !== 'difference' || !this.hasArrows;
    this.edgesButton.setAttribute('aria-pressed', String(Boolean(this.edges)));
    await this.view.setView({ mode: state.mode, colouring, range, arrowScale: this.arrowScale, edges: Boolean(this.edges) });
    if (token !== this.styling) return;
    this.drawScale(colouring, range);
    this.showTime();
  }

  drawScale(colouring, range) {
    this.scale.hidden = colouring.key === 'none';
    if (this.scale.hidden) return;
    const end = (share) => (!range.isCut ? '' : share === 1 ? '≥ ' : share === 0 && colouring.diverging ? '≤ ' : '');
    const text = (share) => `${end(share)}${number(colouring.factor * (range.low + share * (range.high - range.low)), 2)}`;
    this.scale.setAttribute('aria-label', `Colour scale of ${colouring.label} in ${colouring.unit || 'its unit'}, from ${text(0)} to ${text(1)}`);
    this.scale.replaceChildren(
      h('span', { class: 'scale-name' }, `${colouring.label.slice(0, 60)}${colouring.unit ? `, ${colouring.unit}` : ''}`),
      h('div', { class: 'scale-bar-box' },
        h('div', { class: 'scale-colours', style: { background: colourGradient(colouring.diverging) } }),
        h('div', { class: 'scale-ticks' }, [0, 0.25, 0.5, 0.75, 1].map((share) => h('span', {}, text(share))))));
  }

  showTime() {
    const { time } = this.store.get();
    if (!this.data || time === null) return;
    this.timeline.showTime(time);
    this.view.showFrames(this.data.map((one) => (one ? one.frameAt(time) : 0)));
  }

  // Buttons that set time and camera. Of several models, the worst places are those of the left one.
  listWorst(shown, scenes, data) {
    const items = worstPlaces(shown[0].model, scenes[0], data[0]);
    this.view.marked = [...new Set(items.map((item) => item.point).filter((point) => point !== undefined))];
    this.worst.hidden = items.length === 0;
    this.worst.replaceChildren(
      h('h3', {}, `Where the ${shown[0].label === 'reconstruction' ? 'reconstruction' : shown.length > 1 ? 'left model' : 'model'} is worst`),
      h('ul', { class: 'worst-list', 'data-columns': items.length % 3 === 0 ? 3 : 4 }, items.map((item) => h('li', {},
        h('button', { type: 'button', class: 'worst-item', onclick: () => this.goTo(item) },
          h('span', { class: 'worst-title' }, item.title.slice(0, 120)),
          h('span', { class: 'worst-detail muted' }, item.detail || NONE),
          item.part ? h('span', { class: `part part-${item.part.replace(' ', '-')}` }, item.part) : null)))));
    return items;
  }

  goTo(item) {
    if (item.time !== null) this.store.set({ time: item.time });
    if (item.point !== undefined) {
      this.store.set({ point: item.point });
      const data = this.data[0];
      const place = this.view.placeOfPoint(0, item.point, data.frameAt(this.store.get().time));
      if (place) this.view.orbit.lookAt(place);
    } else {
      this.view.orbit.showAll();
    }
  }
}

// All models of all runs, each with a label and a colour.
export function choicesOf(data, labelOf) {
  const runs = data.runs ?? [];
  const all = runs.flatMap((run) => run.models ?? []);
  const colours = new Map();
  const counted = all.filter((model) => model.counts !== false);
  for (const model of [...counted, ...all.filter((one) => !counted.includes(one))]) {
    colours.set(model, colours.size < counted.length ? modelColourName(colours.size, counted.length) : 'series-4');
  }
  return runs.flatMap((run, r) => (run.models ?? []).map((model, m) => ({
    run, model, runIndex: r, modelIndex: m, colour: colours.get(model),
    label: runs.length > 1 ? `${run.name}: ${labelOf(model, m)}` : labelOf(model, m), counts: model.counts !== false,
  })));
}
