// The drawing of one model in one recording: surface, points and arrows, updated in place.
import {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, InstancedBufferAttribute, InstancedBufferGeometry,
  LineBasicMaterial, LineSegments, Mesh, Points, RGBAFormat, Scene, ShaderMaterial, UnsignedByteType, Vector2,
} from 'three';
import { colourTable } from './colours.js';
import { fieldOf } from './scene_data.js';
import { unpack } from './decode.js';
import { ARROWS, POINTS, SURFACE } from './shaders.js';

const NO_VALUE = -1;

const tables = [false, true].map((diverging) => {
  const texture = new DataTexture(colourTable(diverging), 256, 1, RGBAFormat, UnsignedByteType);
  texture.needsUpdate = true;
  return texture;
});

function material(shaders, uniforms, options = {}) {
  return new ShaderMaterial({
    ...shaders, ...options,
    uniforms: { table: { value: tables[0] }, neutral: { value: new Color(0.6, 0.6, 0.6) }, ...uniforms },
  });
}

const dynamic = (array, size) => new BufferAttribute(array, size).setUsage(35048);

function pointCloud(count, ring, size) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', dynamic(new Float32Array(3 * count), 3));
  geometry.setAttribute('value', dynamic(new Float32Array(count).fill(NO_VALUE), 1));
  const points = new Points(geometry, material(POINTS, {
    ring: { value: ring ? 1 : 0 }, size: { value: size }, outline: { value: new Color(0, 0, 0) } }));
  points.frustumCulled = false;
  return points;
}

function arrowSet(count) {
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(
    [0, -1.1, 0, 0, 1.1, 0, 1, 1.1, 0, 1, -1.1, 0, 1, -4, 0, 1, 4, 0, 2, 0, 0]), 3));
  geometry.setIndex([0, 2, 1, 0, 3, 2, 4, 6, 5]);
  const instanced = (size) => new InstancedBufferAttribute(new Float32Array(size * count), size).setUsage(35048);
  geometry.setAttribute('from', instanced(3));
  geometry.setAttribute('to', instanced(3));
  geometry.setAttribute('value', instanced(1));
  const arrows = new Mesh(geometry, material(ARROWS, {
    resolution: { value: new Vector2(1, 1) }, headLength: { value: 9 } }, { side: DoubleSide }));
  arrows.frustumCulled = false;
  return arrows;
}

export class Pane {
  constructor() {
    this.scene = new Scene();
    this.data = null;
    this.objects = [];
  }

  async load(data) {
    if (this.data === data) return;
    for (const object of this.objects) {
      this.scene.remove(object);
      object.geometry.dispose();
      object.material.dispose();
    }
    this.objects = [];
    this.surface = this.edges = this.measured = this.model = this.arrows = null;
    this.data = data;
    this.isExpanded = false;
    if (!data) return;
    if (data.positions) {
      this.addSurface(false);
    }
    if (data.pointCount > 0) {
      const isDense = data.pointCount > 2000;
      const isCloud = isDense && !data.model && Boolean(data.positions);  // a scan about a surface
      const size = isCloud ? 3 : isDense ? 4 : data.pointCount > 300 ? 6 : 11;
      this.measured = this.add(pointCloud(data.pointCount, false, size));
      if (data.model) this.model = this.add(pointCloud(data.pointCount, true, size + 2));
      if (data.model && data.measured) this.arrows = this.add(arrowSet(data.pointCount));
    }
  }

  add(object) {
    this.scene.add(object);
    this.objects.push(object);
    return object;
  }

  // A surface whose values belong to triangles has three vertices of its own for each triangle.
  addSurface(isExpanded) {
    const { data } = this;
    const count = isExpanded ? 3 * data.triangleCount : data.positions.shape[1];
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', dynamic(new Float32Array(3 * count), 3));
    geometry.setAttribute('value', dynamic(new Float32Array(count).fill(NO_VALUE), 1));
    if (!isExpanded) geometry.setIndex(new BufferAttribute(data.indices, 1));
    if (this.surface) {
      this.surface.geometry.dispose();
      this.surface.geometry = geometry;
    } else {
      this.surface = this.add(new Mesh(geometry, material(SURFACE, { opacity: { value: 1 } }, { side: DoubleSide })));
      this.surface.frustumCulled = false;
      this.surface.material.polygonOffset = true;
      this.surface.material.polygonOffsetFactor = 1;
      this.surface.material.polygonOffsetUnits = 1;
      this.nodes = new Float32Array(3 * data.positions.shape[1]);
    }
    this.isExpanded = isExpanded;
  }

  // The edges of the triangles, made when they are first asked for.
  showEdges(visible, colour) {
    if (!this.surface || (!visible && !this.edges)) return;
    if (!this.edges) {
      const { indices } = this.data;
      const pairs = new Set();
      const lines = [];
      for (let t = 0; t < indices.length; t += 3) {
        for (let k = 0; k < 3; ++k) {
          const [a, b] = [indices[t + k], indices[t + ((k + 1) % 3)]];
          const key = a < b ? a * 4294967296 + b : b * 4294967296 + a;
          if (pairs.has(key)) continue;
          pairs.add(key);
          lines.push(a, b);
        }
      }
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', dynamic(new Float32Array(this.nodes.length), 3));
      geometry.setIndex(new BufferAttribute(new Uint32Array(lines), 1));
      this.edges = this.add(new LineSegments(geometry, new LineBasicMaterial({ transparent: true, opacity: 0.35 })));
      this.edges.frustumCulled = false;
    }
    this.edges.material.color.set(colour);
    this.edges.visible = visible;
  }

  // Unpacks the values of a colouring, before frames are shown with it.
  async prepare(colouring) {
    this.field = null;
    if (!this.data || colouring.ofPoints || colouring.key === 'none') return;
    const field = fieldOf(this.data.scene, colouring);
    if (!field) return;
    this.field = await unpack(field.values);
    const onTriangles = field.on === 'triangles';
    if (this.surface && onTriangles !== this.isExpanded) this.addSurface(onTriangles);
  }

  // Shows a frame. `view` has the mode, the colouring with its range, the factor of the arrows and the theme.
  show(frame, view) {
    const { data } = this;
    if (!data) return;
    const { colouring, range, mode } = view;
    const span = range.high - range.low || 1;
    const share = (value) => (Number.isNaN(value) ? NO_VALUE : Math.max(0, (value - range.low) / span));
    const frameOf = (array) => Math.min(frame, array.frames - 1);

    if (this.surface) {
      const visible = mode !== 'measured' || !data.measured;
      this.surface.visible = visible;
      if (this.edges) this.edges.visible = visible && view.edges;
      if (visible) this.showSurface(frameOf(data.positions), share);
      const { uniforms } = this.surface.material;
      uniforms.table.value = tables[colouring.diverging ? 1 : 0];
      uniforms.neutral.value.set(view.theme.surface);
      const opacity = mode === 'difference' ? 0.3 : 1;
      uniforms.opacity.value = opacity;
      this.surface.material.transparent = opacity < 1;
      this.surface.material.depthWrite = opacity === 1;
    }
    if (this.measured) {
      const values = new Float32Array(data.pointCount).fill(NO_VALUE);
      if (colouring.ofPoints) data.residuals(frame, colouring.isOverNoise).forEach((residual, k) => { values[k] = share(residual); });
      this.showPoints(this.measured, data.measured, frame, values, mode !== 'model', this.model || !this.surface ? view.theme.measured : view.theme.scan, view);
      if (this.model) this.showPoints(this.model, data.model, frame, values, mode === 'model' || mode === 'both', view.theme.model, view);
      if (this.arrows) this.showArrows(frame, values, mode, view);
    }
  }

  showSurface(frame, share) {
    const { data, surface, nodes, field, isExpanded } = this;
    data.positions.frame(frame, nodes);
    const position = surface.geometry.getAttribute('position');
    const value = surface.geometry.getAttribute('value');
    const fieldFrame = field ? field.frame(Math.min(frame, field.frames - 1)) : null;
    if (isExpanded) {
      const { indices } = data;
      for (let k = 0; k < indices.length; ++k) {
        const from = 3 * indices[k];
        position.array[3 * k] = nodes[from];
        position.array[3 * k + 1] = nodes[from + 1];
        position.array[3 * k + 2] = nodes[from + 2];
      }
      for (let t = 0; t < data.triangleCount; ++t) value.array.fill(fieldFrame ? share(fieldFrame[t]) : NO_VALUE, 3 * t, 3 * t + 3);
    } else {
      position.array.set(nodes);
      if (fieldFrame) for (let k = 0; k < fieldFrame.length; ++k) value.array[k] = share(fieldFrame[k]);
      else value.array.fill(NO_VALUE);
    }
    position.needsUpdate = true;
    value.needsUpdate = true;
    if (this.edges?.visible) {
      const ends = this.edges.geometry.getAttribute('position');
      ends.array.set(nodes);
      ends.needsUpdate = true;
    }
  }

  // Points that were not observed are left out.
  showPoints(points, array, frame, values, visible, colour, view) {
    points.visible = visible && Boolean(array);
    if (!points.visible) return;
    const places = array.frame(Math.min(frame, array.frames - 1));
    const position = points.geometry.getAttribute('position');
    const value = points.geometry.getAttribute('value');
    let count = 0;
    for (let k = 0; k < values.length; ++k) {
      if (Number.isNaN(places[3 * k])) continue;
      position.array.set(places.subarray(3 * k, 3 * k + 3), 3 * count);
      value.array[count++] = values[k];
    }
    points.geometry.setDrawRange(0, count);
    position.needsUpdate = true;
    value.needsUpdate = true;
    const { uniforms } = points.material;
    uniforms.table.value = tables[view.colouring.diverging ? 1 : 0];
    uniforms.neutral.value.set(colour);
    uniforms.outline.value.set(view.theme.outline);
  }

  showArrows(frame, values, mode, view) {
    const { arrows, data } = this;
    arrows.visible = mode === 'difference';
    if (!arrows.visible) return;
    const from = data.measured.frame(frame), to = data.model.frame(frame);
    const { geometry } = arrows;
    const [start, end, value] = ['from', 'to', 'value'].map((name) => geometry.getAttribute(name));
    let count = 0;
    for (let k = 0; k < values.length; ++k) {
      if (Number.isNaN(from[3 * k]) || Number.isNaN(to[3 * k])) continue;
      for (let c = 0; c < 3; ++c) {
        start.array[3 * count + c] = from[3 * k + c];
        end.array[3 * count + c] = from[3 * k + c] + view.arrowScale * (to[3 * k + c] - from[3 * k + c]);
      }
      value.array[count++] = values[k];
    }
    geometry.instanceCount = count;
    start.needsUpdate = end.needsUpdate = value.needsUpdate = true;
    const { uniforms } = arrows.material;
    uniforms.table.value = tables[view.colouring.diverging ? 1 : 0];
    uniforms.neutral.value.set(view.theme.arrow);
  }
}
