// Vectors as arrays of three, quaternions as (x, y, z, w), body to inertial.

/** a . b */
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** a - b */
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

/** a + s b */
const plus = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];

const length = (a) => Math.hypot(a[0], a[1], a[2]);

const clamp = (value, least, most) => Math.min(Math.max(value, least), most);

/** v turned by the unit quaternion q: v + 2 w (u x v) + 2 u x (u x v). */
function turned(q, v) {
  const [x, y, z, w] = q;
  const cx = 2 * (y * v[2] - z * v[1]);
  const cy = 2 * (z * v[0] - x * v[2]);
  const cz = 2 * (x * v[1] - y * v[0]);
  return [
    v[0] + w * cx + y * cz - z * cy,
    v[1] + w * cy + z * cx - x * cz,
    v[2] + w * cz + x * cy - y * cx,
  ];
}

/** The rotation as a matrix by columns, for WebGL. */
function rotationMatrix(q) {
  return [...turned(q, [1, 0, 0]), ...turned(q, [0, 1, 0]), ...turned(q, [0, 0, 1])];
}

/** The least of 1, 2, 5 times a power of ten that is not below the value. */
function niceAbove(value) {
  if (!(value > 0)) return 1;
  const decade = 10 ** Math.floor(Math.log10(value));
  const factor = [1, 2, 5, 10].find((it) => it * decade >= value * (1 - 1e-9));
  return (factor ?? 10) * decade;
}

/** A number as people write it: so many decimals as a step of this size needs. */
function decimals(value, step) {
  const count = clamp(Math.ceil(-Math.log10(step) - 1e-9), 0, 8);
  const text = value.toFixed(count);
  return Number(text) === 0 ? (0).toFixed(count) : text.replace('-', '\u2212');
}
