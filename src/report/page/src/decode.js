// Unpacks the arrays of the report: base64, gzip, 16-bit numbers as differences from frame to frame.

const NOT_OBSERVED = -32768;

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) bytes[k] = text.charCodeAt(k);
  return bytes;
}

async function inflate(bytes) {
  if (typeof DecompressionStream === 'undefined') {
    throw new Error('This browser cannot unpack the motion (it has no DecompressionStream). '
      + 'Chrome and Edge from 80, Firefox from 113 and Safari from 16.4 can.');
  }
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Response(stream).arrayBuffer();
}

// An array of frames. Values are computed for one frame at a time, so that a long motion takes no
// more memory than its 16-bit numbers.
export class FrameArray {
  constructor(packed, values) {
    this.shape = packed.shape;
    this.frames = packed.shape[0] ?? 0;
    this.stride = packed.shape.slice(1).reduce((product, size) => product * size, 1);
    this.values = values;
    this.isQuantised = packed.type === 'int16';
    this.low = packed.low ?? 0;
    this.step = this.isQuantised ? ((packed.high ?? 0) - this.low) / 65534 : 0;
  }

  // The values of one frame, NaN where nothing was observed. `out` is filled if given.
  frame(index, out = new Float32Array(this.stride)) {
    const from = index * this.stride;
    if (!this.isQuantised) {
      out.set(this.values.subarray(from, from + this.stride));
      return out;
    }
    const { values, low, step, stride } = this;
    for (let k = 0; k < stride; ++k) {
      const value = values[from + k];
      out[k] = value === NOT_OBSERVED ? NaN : low + (value + 32767) * step;
    }
    return out;
  }
}

const unpacked = new WeakMap();

// The FrameArray of a packed array; a second call for the same one returns the first result.
export function unpack(packed) {
  if (!packed) return Promise.resolve(null);
  if (!unpacked.has(packed)) unpacked.set(packed, unpackNow(packed));
  return unpacked.get(packed);
}

async function unpackNow(packed) {
  const buffer = await inflate(bytesOf(packed.base64));
  packed.base64 = '';  // The text is not needed again.
  const type = { float32: Float32Array, int16: Int16Array, uint32: Uint32Array }[packed.type];
  if (!type) throw new Error(`An array has the unknown type "${packed.type}".`);
  const values = new type(buffer);
  const array = new FrameArray(packed, values);
  if (values.length < array.frames * array.stride) throw new Error('An array is shorter than its shape says.');
  if (packed.delta && array.isQuantised) {
    // 16-bit addition wraps around, as the differences did.
    for (let k = array.stride; k < values.length; ++k) values[k] += values[k - array.stride];
  }
  return array;
}
