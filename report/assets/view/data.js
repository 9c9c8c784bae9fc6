// Runs as the page carries them, and as they are at a time.

/** The runs in a text as `page/view.rs` writes it. */
function readRuns(text) {
  const { origin_m, runs } = JSON.parse(text);
  return { origin_m, runs: runs.map(readRun).filter((run) => run.times_s.length > 0) };
}

function readRun(run, index) {
  return {
    index,
    name: run.name,
    shown: true,
    times_s: new Float64Array(bytes(run.times_s)),
    bodies: run.bodies.map((body) => ({
      ...body,
      radius_m: Math.max(...body.parts.map(reach)),
      positions_m: new Float32Array(bytes(body.positions_m)),
      attitudes: new Float32Array(bytes(body.attitudes)),
      wind_m_s: new Float32Array(bytes(body.wind_m_s)),
    })),
    tethers: run.tethers.map((tether) => ({
      ...tether,
      points_m: new Float32Array(bytes(tether.points_m)),
      tensions_n: new Float32Array(bytes(tether.tensions_n)),
    })),
    events: run.events,
  };
}

function bytes(text) {
  const letters = atob(text);
  const array = new Uint8Array(letters.length);
  for (let index = 0; index < letters.length; index += 1) array[index] = letters.charCodeAt(index);
  return array.buffer;
}

/** How far a part reaches from its body's place, m. */
function reach(part) {
  const { solid } = part;
  const own = {
    sphere: () => solid.radius_m,
    box: () => 0.5 * length(solid.size_m),
    cylinder: () => Math.hypot(solid.radius_m, 0.5 * solid.height_m),
  }[solid.kind]();
  return own + length(part.at_m);
}

/** The frame at or before a time and the part of the way to the next; the ends stay. */
function placeOf(times_s, time_s) {
  let low = 0;
  let high = times_s.length - 1;
  if (time_s >= times_s[high]) return { frame: high, part: 0 };
  if (time_s <= times_s[0]) return { frame: 0, part: 0 };
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times_s[middle] <= time_s) low = middle;
    else high = middle;
  }
  return { frame: low, part: (time_s - times_s[low]) / (times_s[low + 1] - times_s[low]) };
}

/** Three numbers of a frame and of the next, in between. */
function between(values, { frame, part }) {
  const at = 3 * frame;
  const next = part > 0 ? at + 3 : at;
  return [0, 1, 2].map((k) => values[at + k] + part * (values[next + k] - values[at + k]));
}

/** Attitude in between: linear, then of unit length; neighbours are in one hemisphere. */
function attitudeAt(body, { frame, part }) {
  const at = 4 * frame;
  const next = part > 0 ? at + 4 : at;
  const mixed = [0, 1, 2, 3].map(
    (k) => (1 - part) * body.attitudes[at + k] + part * body.attitudes[next + k]);
  const norm = Math.hypot(...mixed) || 1;
  return mixed.map((value) => value / norm);
}

/** Velocity of a body in a frame, inertial, m/s: the difference over the neighbours. */
function velocityAt(run, body, { frame }) {
  const last = run.times_s.length - 1;
  const [from, to] = [Math.max(frame - (frame === last ? 1 : 0), 0), Math.min(frame + 1, last)];
  const interval_s = run.times_s[to] - run.times_s[from];
  if (!(interval_s > 0)) return [0, 0, 0];
  return [0, 1, 2].map(
    (k) => (body.positions_m[3 * to + k] - body.positions_m[3 * from + k]) / interval_s);
}

/** Points of a tether in between, in one array, and where its tensions begin. */
function tetherAt(tether, place) {
  const count = tether.segments;
  const first = 3 * (count + 1) * place.frame;
  const tensions = tether.tensions_n.subarray(count * place.frame, count * (place.frame + 1));
  const points = Float64Array.from(tether.points_m.subarray(first, first + 3 * (count + 1)));
  if (place.part > 0) move(tether, place, points, tensions);
  return { points, tensions };
}

/** Moves the points of a frame towards the next one. */
function move(tether, { frame, part }, points, tensions) {
  const count = tether.segments;
  const next = tether.points_m.subarray(3 * (count + 1) * (frame + 1), 3 * (count + 1) * (frame + 2));
  const later = tether.tensions_n.subarray(count * (frame + 1), count * (frame + 2));
  const [now, then] = [present(tensions), present(later)];
  // A line that is reeled has its nodes numbered anew: its points are compared by their part of the line.
  const reeled = then > now || (then < now && endStays(points, now, next, then));
  let shift = [0, 0, 0];
  for (let index = 0; index <= count; index += 1) {
    const there = reeled ? pointAt(next, clamp(index / now, 0, 1) * then) : pointAt(next, index);
    // What is cut off before the next frame goes with its neighbour.
    const bound = reeled || index === 0 || !Number.isNaN(later[index - 1]) || Number.isNaN(tensions[index - 1]);
    if (bound) shift = [0, 1, 2].map((k) => there[k] - points[3 * index + k]);
    for (let k = 0; k < 3; k += 1) points[3 * index + k] += part * shift[k];
  }
}

/** How many segments there are up to the last one. */
function present(tensions) {
  let count = tensions.length;
  while (count > 0 && Number.isNaN(tensions[count - 1])) count -= 1;
  return count;
}

/** Whether the end of the line is where it was, to half a segment. */
function endStays(points, now, next, then) {
  const end = pointAt(points, now);
  const segment = length(minus(end, pointAt(points, now - 1)));
  return length(minus(end, pointAt(next, then))) < 0.5 * segment;
}

/** The point at a number that need not be whole. */
function pointAt(points, number) {
  const index = Math.floor(number);
  const rest = number - index;
  const at = 3 * index;
  return [0, 1, 2].map((k) => points[at + k] + (rest > 0 ? rest * (points[at + 3 + k] - points[at + k]) : 0));
}

/** Everything of a run at a time. */
function stateOf(run, time_s) {
  const place = placeOf(run.times_s, time_s);
  return {
    run,
    place,
    bodies: run.bodies.map((body) => ({
      body,
      position_m: between(body.positions_m, place),
      attitude: attitudeAt(body, place),
      wind_m_s: between(body.wind_m_s, place),
      velocity_m_s: velocityAt(run, body, place),
    })),
    tethers: run.tethers.map((tether) => ({ tether, ...tetherAt(tether, place) })),
  };
}

/** The scale of tensions of all runs, N: from 0, or from near the least where all are alike. */
function tensionScale(runs) {
  let least_n = Infinity;
  let most_n = 0;
  for (const run of runs) {
    for (const tether of run.tethers) {
      for (const tension_n of tether.tensions_n) {
        if (tension_n > 0) {
          least_n = Math.min(least_n, tension_n);
          most_n = Math.max(most_n, tension_n);
        }
      }
    }
  }
  if (!(most_n > 0)) return undefined;
  const step = niceAbove((most_n - Math.min(least_n, 0.999 * most_n)) / 5);
  const bottom_n = least_n > 0.5 * most_n ? Math.floor(least_n / step) * step : 0;
  const top_n = Math.ceil(most_n / niceAbove((most_n - bottom_n) / 5)) * niceAbove((most_n - bottom_n) / 5);
  return { least_n: bottom_n, most_n: top_n, step_n: niceAbove((top_n - bottom_n) / 5) };
}
