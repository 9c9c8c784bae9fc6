// The cage: a floor and two walls away from the eye, with a grid in metres and numbers at their edges.

const GRID = rgb('d9dde1');
const EDGE = rgb('8d959c');
/** Least pixels between the lines of the grid. */
const GRID_PIXELS = 75;
const AXIS_NAMES = ['x, downwind [m]', 'y, left [m]', 'z, altitude [m]'];

/** The box of the grid: what is looked at, as far as it is in the picture. */
function cageOf(camera, { centre_m, half_m }) {
  const step = niceAbove(GRID_PIXELS / camera.pixelsPerMetre());
  const seen_m = 0.4 * camera.height_m;
  const low = [];
  const high = [];
  for (let k = 0; k < 3; k += 1) {
    let from = Math.max(centre_m[k] - half_m[k], camera.target_m[k] - seen_m);
    let to = Math.min(centre_m[k] + half_m[k], camera.target_m[k] + seen_m);
    if (to <= from) [from, to] = [camera.target_m[k] - seen_m, camera.target_m[k] + seen_m];
    low.push(from);
    high.push(to);
  }
  return { low, high, step };
}

/** All of the box, whether it is in the picture or not. */
function cageAbout(camera, centre_m, half_m) {
  const step = niceAbove(GRID_PIXELS / camera.pixelsPerMetre());
  return { low: minus(centre_m, half_m), high: plus(centre_m, half_m), step };
}

/** The multiples of the step of the grid along an axis, from the origin of the runs, m. */
function marksOf(axis, { low, high, step }, origin_m) {
  const from = Math.ceil((low[axis] + origin_m[axis]) / step - 1e-6);
  const to = Math.floor((high[axis] + origin_m[axis]) / step + 1e-6);
  return Array.from({ length: Math.max(to - from + 1, 0) }, (_, index) => (from + index) * step - origin_m[axis]);
}

function cornersOf({ low, high }) {
  const corners = [];
  for (let index = 0; index < 8; index += 1) {
    corners.push([0, 1, 2].map((k) => ((index >> k) & 1 ? high[k] : low[k])));
  }
  return corners;
}

/** Where each axis has its wall: on the side away from the eye; the floor is below unless seen from below. */
function wallsOf({ low, high }, camera) {
  const { toEye } = camera.axes();
  return [0, 1, 2].map((k) => (toEye[k] > (k === 2 ? -1e-6 : 0) ? low[k] : high[k]));
}

/** Gathers the lines of the grid. */
function addGrid(lines, cage, camera, origin_m) {
  const walls = wallsOf(cage, camera);
  const { low, high } = cage;
  const relative = (point) => minus(point, camera.target_m);
  for (let wall = 0; wall < 3; wall += 1) {
    for (const along of [0, 1, 2]) {
      if (along === wall) continue;
      const other = 3 - wall - along;
      const draw = (mark, colour, opacity) => {
        const from = [0, 0, 0];
        from[wall] = walls[wall];
        from[other] = mark;
        from[along] = low[along];
        const to = [...from];
        to[along] = high[along];
        lines.add(relative(from), relative(to), colour, opacity, 1);
      };
      for (const mark of marksOf(other, cage, origin_m)) draw(mark, GRID, 1);
      for (const side of [low, high]) draw(side[other], EDGE, 0.7);
    }
  }
}

/** The edge of the cage at which an axis has its numbers: two points, or nothing where one looks along it. */
function edgeOf(axis, cage, camera) {
  const walls = wallsOf(cage, camera);
  const { low, high } = cage;
  const across = (k) => (walls[k] === low[k] ? high[k] : low[k]);
  let corner = [...walls];
  if (axis < 2) {
    corner[1 - axis] = across(1 - axis);
  } else {
    const candidates = [0, 1, 2, 3].map((it) => [it & 1 ? low[0] : high[0], it & 2 ? low[1] : high[1], low[2]]);
    const left = (point) => camera.project(point)?.x ?? Infinity;
    corner = candidates.reduce((best, it) => (left(it) < left(best) - 0.5 ? it : best));
  }
  const ends = [low, high].map((side) => corner.map((value, k) => (k === axis ? side[k] : value)));
  const [a, b] = ends.map((end) => camera.project(end));
  if (!a || !b || Math.hypot(a.x - b.x, a.y - b.y) < 30) return undefined;
  return { ends, a, b };
}

/** Numbers and names of the axes: texts with their places in the picture. */
function ticksOf(cage, camera, origin_m) {
  const texts = [];
  const middle = camera.project(cage.low.map((low, k) => 0.5 * (low + cage.high[k])));
  if (!middle) return texts;
  for (let axis = 0; axis < 3; axis += 1) {
    const edge = edgeOf(axis, cage, camera);
    if (!edge) continue;
    const { a, b, ends } = edge;
    const outward = outwardOf(a, b, middle);
    for (const mark of marksOf(axis, cage, origin_m)) {
      const at = camera.project(ends[0].map((value, k) => (k === axis ? mark : value)));
      if (at) addApart(texts, tick(decimals(mark + origin_m[axis], cage.step), at, outward, 8));
    }
    texts.push({ ...nameOf(axis, edge, outward), isName: true });
  }
  return texts;
}

/** The name of an axis: above the upright one, beyond the numbers of the others. */
function nameOf(axis, { a, b }, outward) {
  const isUpright = axis === 2 && Math.abs(outward[0]) > 0.7;
  if (isUpright) return { text: AXIS_NAMES[axis], x: b.x, y: Math.min(a.y, b.y) - 2, align: -100, vertical: -100 };
  const centre = { x: 0.5 * (a.x + b.x), y: 0.5 * (a.y + b.y) };
  return tick(AXIS_NAMES[axis], centre, outward, Math.abs(outward[0]) * 48 + Math.abs(outward[1]) * 26);
}

/** Adds a text where it covers none that is there. */
function addApart(texts, added) {
  const boxOf = ({ text, x, y, align, vertical }) => {
    const width = 7 * text.length + 6;
    return box(x + 0.01 * align * width, y + 0.14 * vertical, width, 14);
  };
  if (!texts.some((other) => overlap(boxOf(other), boxOf(added)))) texts.push(added);
}

/** The unit vector of the picture from the middle across an edge. */
function outwardOf(a, b, middle) {
  const along = [b.x - a.x, b.y - a.y];
  const norm = Math.hypot(...along);
  let outward = [-along[1] / norm, along[0] / norm];
  const away = [0.5 * (a.x + b.x) - middle.x, 0.5 * (a.y + b.y) - middle.y];
  if (outward[0] * away[0] + outward[1] * away[1] < 0) outward = outward.map((it) => -it);
  return outward;
}

/** A text beside a place: on that side of it where it does not cover the edge. */
function tick(text, at, outward, distance) {
  const align = Math.round(-50 + 50 * clamp(1.6 * outward[0], -1, 1));
  const vertical = Math.round(-50 + 50 * clamp(1.6 * outward[1], -1, 1));
  return { text, x: at.x + distance * outward[0], y: at.y + distance * outward[1], align, vertical };
}
