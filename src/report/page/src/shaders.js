// Shaders of the 3D view. Colours come from a table, looked up by a value between 0 and 1; a value
// below −0.5 stands for "no value".

const COLOUR = /* glsl */ `
  uniform sampler2D table;
  uniform vec3 neutral;
  vec3 colourOf(float value) {
    return value < -0.5 ? neutral : texture2D(table, vec2(clamp(value, 0.002, 0.998), 0.5)).rgb;
  }`;

// The normal comes from the derivatives of the position, so that nothing has to be computed when
// the surface moves.
export const SURFACE = {
  vertexShader: /* glsl */ `
    attribute float value;
    varying float vValue;
    varying vec3 vView;
    void main() {
      vec4 view = modelViewMatrix * vec4(position, 1.0);
      vValue = value;
      vView = view.xyz;
      gl_Position = projectionMatrix * view;
    }`,
  fragmentShader: /* glsl */ `
    varying float vValue;
    varying vec3 vView;
    uniform float opacity;
    ${COLOUR}
    void main() {
      vec3 normal = normalize(cross(dFdx(vView), dFdy(vView)));
      float light = 0.55 + 0.45 * abs(dot(normal, normalize(vec3(0.25, 0.45, 0.85))));
      gl_FragColor = vec4(colourOf(vValue) * light, opacity);
    }`,
};

// Discs of a fixed size in pixels: filled ones are measured, rings are predicted.
export const POINTS = {
  vertexShader: /* glsl */ `
    attribute float value;
    uniform float size;
    varying float vValue;
    void main() {
      vValue = value;
      // A little nearer to the camera, so that the surface below does not cut the disc.
      gl_Position = projectionMatrix * vec4((modelViewMatrix * vec4(position, 1.0)).xyz * 0.97, 1.0);
      gl_PointSize = size;
    }`,
  fragmentShader: /* glsl */ `
    varying float vValue;
    uniform float ring, size;
    uniform vec3 outline;
    ${COLOUR}
    void main() {
      float radius = length(gl_PointCoord - 0.5) * size;
      float outer = 0.5 * size - 0.5;
      if (radius > outer) discard;
      if (ring > 0.5 && radius < outer - 3.0) discard;
      float edge = ring > 0.5 || size < 5.0 ? 0.0 : smoothstep(outer - 1.9, outer - 0.9, radius);
      gl_FragColor = vec4(mix(colourOf(vValue), outline, edge), 1.0);
    }`,
};

// Arrows of a fixed width in pixels. Of each vertex, along is its place on the shaft (0), at the
// foot of the head (1) or at the tip (2), and side its distance from the axis in pixels.
export const ARROWS = {
  vertexShader: /* glsl */ `
    attribute vec3 from, to;
    attribute float value;
    uniform vec2 resolution;
    uniform float headLength;
    varying float vValue;
    void main() {
      vValue = value;
      vec4 a = projectionMatrix * modelViewMatrix * vec4(from, 1.0);
      vec4 b = projectionMatrix * modelViewMatrix * vec4(to, 1.0);
      vec2 pixels = (b.xy / b.w - a.xy / a.w) * 0.5 * resolution;
      float size = length(pixels);
      vec2 direction = size > 1e-6 ? pixels / size : vec2(1.0, 0.0);
      float head = min(headLength, size);
      float scale = headLength > 0.0 ? head / headLength : 1.0;
      float along = position.x < 0.5 ? 0.0 : (position.x < 1.5 ? size - head : size);
      vec2 offset = direction * along + vec2(-direction.y, direction.x) * position.y * (position.x < 0.5 ? min(1.0, scale * 2.0) : scale);
      float share = size > 1e-6 ? along / size : 0.0;
      vec4 place = mix(a, b, share);
      gl_Position = vec4((a.xy / a.w + offset / (0.5 * resolution)) * place.w, place.z, place.w);
    }`,
  fragmentShader: /* glsl */ `
    varying float vValue;
    ${COLOUR}
    void main() { gl_FragColor = vec4(colourOf(vValue), 1.0); }`,
};
