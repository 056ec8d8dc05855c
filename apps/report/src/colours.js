// What colour a direction, an angle or a value has.

/** Corners of the triangle of directions: along x, y, z. Linear mixtures by the squares of the components, which are the
    same for u and -u and add up to 1. */
const kCorners = [[0.86, 0.2, 0.14], [0.1, 0.52, 0.3], [0.1, 0.27, 0.78]];

const toSrgb = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);

/** Linear RGB of the axis (x, y, z), a unit vector. */
export function directionColour(x, y, z) {
  const w = [x * x, y * y, z * z];
  // Between the corners: lighter, so that mixtures do not turn to mud.
  const mixed = 1 - Math.max(...w);
  return [0, 1, 2].map((k) => {
    const c = w[0] * kCorners[0][k] + w[1] * kCorners[1][k] + w[2] * kCorners[2][k];
    return c + (0.95 - c) * 0.42 * mixed;
  });
}

/** Dark blue to pale yellow through green, of even steps in lightness. */
const kRamp = ['#2b1d5c', '#2c4486', '#266c94', '#2a9188', '#57b275', '#a3cc6a', '#f1e08a'];

function parse(text) {
  return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);
}

/** sRGB of a share between 0 and 1. */
export function rampColour(share) {
  const place = Math.min(1, Math.max(0, share)) * (kRamp.length - 1);
  const k = Math.min(kRamp.length - 2, Math.floor(place));
  const [a, b] = [parse(kRamp[k]), parse(kRamp[k + 1])];
  return a.map((x, i) => x + (b[i] - x) * (place - k));
}

export function cssRgb(srgb) {
  return `rgb(${srgb.map((x) => Math.round(255 * Math.min(1, Math.max(0, x)))).join(' ')})`;
}

export function linearToSrgb(colour) {
  return colour.map((x) => toSrgb(Math.min(1, Math.max(0, x))));
}

export function srgbToLinear(colour) {
  return colour.map((x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4));
}

export const rampGradient = `linear-gradient(90deg, ${kRamp.join(', ')})`;

/** Shades of sRGB for linear ones in even steps: a power for every spot of a picture takes long. */
const kShades = Uint8ClampedArray.from({ length: 1025 }, (_, k) => 255 * toSrgb(k / 1024));

/** A ball whose spots have the colours of the directions that they point in. `turn`: the matrix, column by column, that
    takes directions of the picture (x right, y up, z to the reader) to those of the box. */
export function directionBall(image, turn) {
  const { data, width } = image;
  for (let row = 0; row < width; row += 1) {
    for (let column = 0; column < width; column += 1) {
      const x = (2 * column + 1) / width - 1;
      const y = 1 - (2 * row + 1) / width;
      const r2 = x * x + y * y;
      if (r2 > 1) continue;
      const z = Math.sqrt(1 - r2);
      const [a, b, c] = [0, 1, 2].map((k) => turn[k] * x + turn[4 + k] * y + turn[8 + k] * z);
      const colour = directionColour(a, b, c);
      const shade = 0.78 + 0.3 * z;
      const at = 4 * (row * width + column);
      for (let k = 0; k < 3; k += 1) data[at + k] = kShades[Math.min(1024, Math.round(1024 * shade * colour[k]))];
      data[at + 3] = 255 * Math.min(1, (1 - Math.sqrt(r2)) * width * 0.5);
    }
  }
}
