// A camera on a sphere about a target: turned, moved and zoomed by mouse, touch and keyboard.
import { PerspectiveCamera, Vector3 } from 'three';

const FIELD_OF_VIEW = 30;
const STEP = Math.PI / 24;
const SMALLEST_VIEW = 0.6;  // share of the largest visible surface that is seen at least

const directionAt = (azimuth, elevation) => [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];

export class OrbitCamera {
  constructor(element, onChange) {
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
    this.target = new Vector3();
    this.onChange = onChange;
    this.home = { centre: [0, 0, 0], radius: 1 };
    this.azimuth = this.elevation = 0;
    this.distance = 4;
    this.basis = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
    this.listen(element);
  }

  // Sets the upward direction and what "everything" is.
  setHome(bounds, up) {
    this.home = bounds;
    const z = new Vector3(...(up ?? [0, 0, 1])).normalize();
    const x = new Vector3(1, 0, 0);
    if (Math.abs(z.dot(x)) > 0.9) x.set(0, 1, 0);
    x.addScaledVector(z, -z.dot(x)).normalize();
    this.basis = [x, new Vector3().crossVectors(z, x), z];
    this.showAll();
  }

  showAll() {
    const [x, y, z] = this.homeDirection();
    this.azimuth = Math.atan2(y, x);
    this.elevation = Math.asin(z);
    this.target.set(...this.home.centre);
    this.distance = this.fitting(this.home.radius);
    this.onChange();
  }

  // From the side and a little above; a sheet, which might be seen edge-on from there, from where
  // more of its surface is visible.
  homeDirection() {
    const toWorld = ([x, y, z]) => this.basis.reduce((sum, axis, k) => sum.addScaledVector(axis, [x, y, z][k]), new Vector3());
    const area = (direction) => {
      const { normals } = this.home, { x, y, z } = toWorld(direction);
      let sum = 0;
      for (let k = 0; k < (normals?.length ?? 0); k += 3) sum += Math.abs(normals[k] * x + normals[k + 1] * y + normals[k + 2] * z);
      return sum;
    };
    const usual = directionAt(-0.95, 0.38);
    const others = [0.38, 0.85].flatMap((elevation) => Array.from({ length: 12 }, (_, k) => directionAt(-0.95 + (k * Math.PI) / 6, elevation)));
    const best = others.reduce((a, b) => (area(b) > area(a) ? b : a));
    return area(usual) < SMALLEST_VIEW * area(best) ? best : usual;
  }

  lookAt(place, share = 0.45) {
    this.target.set(...place);
    this.distance = this.fitting(this.home.radius) * share;
    this.onChange();
  }

  fitting(radius) {
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360) * Math.min(1, this.camera.aspect);
    return (0.86 * radius) / Math.sin(Math.atan(half));
  }

  setAspect(aspect) {
    if (aspect === this.camera.aspect) return;
    const before = this.fitting(1);
    this.camera.aspect = aspect;
    this.distance *= this.fitting(1) / before;
  }

  place() {
    const [x, y, z] = this.basis;
    const flat = Math.cos(this.elevation);
    const direction = new Vector3()
      .addScaledVector(x, flat * Math.cos(this.azimuth)).addScaledVector(y, flat * Math.sin(this.azimuth))
      .addScaledVector(z, Math.sin(this.elevation));
    this.camera.position.copy(this.target).addScaledVector(direction, this.distance);
    this.camera.up.copy(z);
    this.camera.near = this.distance / 100;
    this.camera.far = this.distance + 20 * this.home.radius;
    this.camera.lookAt(this.target);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  turn(right, up) {
    this.azimuth -= right;
    this.elevation = Math.min(Math.max(this.elevation + up, -1.55), 1.55);
    this.onChange();
  }

  // Moves the target by a share of the height of the view.
  move(right, up) {
    const height = 2 * this.distance * Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    const { elements } = this.camera.matrixWorld;
    this.target.x -= height * (right * elements[0] + up * elements[4]);
    this.target.y -= height * (right * elements[1] + up * elements[5]);
    this.target.z -= height * (right * elements[2] + up * elements[6]);
    this.onChange();
  }

  zoom(factor) {
    const all = this.fitting(this.home.radius);
    this.distance = Math.min(Math.max(this.distance * factor, all / 100), all * 5);
    this.onChange();
  }

  listen(element) {
    const pointers = new Map();
    let spread = 0;
    const gap = () => {
      const [a, b] = [...pointers.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    element.addEventListener('pointerdown', (event) => {
      element.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (pointers.size === 2) spread = gap();
    });
    element.addEventListener('pointermove', (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const [right, down] = [event.clientX - before.x, event.clientY - before.y];
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      const height = element.clientHeight || 1;
      if (pointers.size === 2) {
        const now = gap();
        this.move(right / (2 * height), -down / (2 * height));
        if (spread > 0 && now > 0) this.zoom(spread / now);
        spread = now;
      } else if (event.buttons & 2 || event.shiftKey) {
        this.move(right / height, -down / height);
      } else {
        this.turn((4 * right) / height, (4 * down) / height);
      }
    });
    for (const name of ['pointerup', 'pointercancel']) element.addEventListener(name, (event) => pointers.delete(event.pointerId));
    element.addEventListener('contextmenu', (event) => event.preventDefault());
    // The wheel scrolls the page unless the view has the focus.
    element.addEventListener('wheel', (event) => {
      if (document.activeElement !== element && !event.ctrlKey) return;
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * 0.0012));
    }, { passive: false });
    element.addEventListener('keydown', (event) => {
      if (this.press(event.key, event.shiftKey)) event.preventDefault();
    });
  }

  press(key, shift) {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[key];
    if (arrows && shift) this.move(0.05 * arrows[0], 0.05 * arrows[1]);
    else if (arrows) this.turn(STEP * arrows[0], STEP * arrows[1]);
    else if (key === '+' || key === '=') this.zoom(0.85);
    else if (key === '-' || key === '_') this.zoom(1 / 0.85);
    else if (key === '0' || key === 'Home') this.showAll();
    else return false;
    return true;
  }
}
