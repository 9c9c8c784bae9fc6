// What is looked at: the whole of it, everything as it moves along, or a body; and how large that is.

/** Half of what is seen about a body, in its radii, and at least in metres. */
const ABOUT_A_BODY = 2.6;
const LEAST_HALF_M = 1.5;
/** A cage is at least this part of its longest edge wide, and so much larger than what is in it. */
const LEAST_WIDTH = 0.25;
const MARGIN = 1.04;

/** The smallest box about points; empty at first. */
class Extent {
  constructor() {
    this.low = [Infinity, Infinity, Infinity];
    this.high = [-Infinity, -Infinity, -Infinity];
  }

  take(x, y, z, radius = 0) {
    const at = [x, y, z];
    for (let k = 0; k < 3; k += 1) {
      this.low[k] = Math.min(this.low[k], at[k] - radius);
      this.high[k] = Math.max(this.high[k], at[k] + radius);
    }
  }

  centre() {
    return this.low.map((low, k) => (low <= this.high[k] ? 0.5 * (low + this.high[k]) : 0));
  }

  half() {
    return this.low.map((low, k) => Math.max(0, 0.5 * (this.high[k] - low)));
  }
}

/** Takes a frame of a run into an extent. */
function takeFrame(extent, run, frame) {
  for (const body of run.bodies) {
    const at = 3 * frame;
    const place = body.positions_m;
    extent.take(place[at], place[at + 1], place[at + 2], body.radius_m);
  }
  for (const { points_m, segments } of run.tethers) {
    const end = 3 * (segments + 1) * (frame + 1);
    for (let at = 3 * (segments + 1) * frame; at < end; at += 3) {
      extent.take(points_m[at], points_m[at + 1], points_m[at + 2]);
    }
  }
}

/** What can be looked at: for each its name, half of its size, its centre, and whether that moves. */
function looksOf(runs) {
  const whole = new Extent();
  let moving_m = [0, 0, 0];
  for (const run of runs) {
    for (let frame = 0; frame < run.times_s.length; frame += 1) {
      const now = new Extent();
      takeFrame(now, run, frame);
      takeFrame(whole, run, frame);
      moving_m = now.half().map((half, k) => Math.max(half, moving_m[k]));
    }
  }
  const looks = [
    { key: 'whole', name: 'whole', half_m: roomy(whole.half()), centre: () => whole.centre() },
    { key: 'moving', name: 'whole, moving along', half_m: roomy(moving_m), centre: centreOfAll },
  ];
  const names = new Set(runs.flatMap((run) => run.bodies.map((body) => body.name)));
  for (const name of names) looks.push(bodyLook(runs, name));
  // Where the system leaves its own place by far, one sees more of it from a camera that goes with it.
  const travels = Math.max(...whole.half()) > 2.5 * Math.max(...moving_m);
  return { looks, first: looks[travels ? 1 : 0] };
}

function roomy(half_m) {
  const most_m = Math.max(...half_m, 0.1);
  return half_m.map((half) => MARGIN * Math.max(half, LEAST_WIDTH * most_m));
}

function bodyLook(runs, name) {
  const bodies = runs.flatMap((run) => run.bodies.filter((body) => body.name === name));
  const radius_m = Math.max(...bodies.map((body) => body.radius_m));
  const half_m = Math.max(ABOUT_A_BODY * radius_m, LEAST_HALF_M);
  return {
    key: `body:${name}`,
    name,
    body: name,
    half_m: [half_m, half_m, half_m],
    centre: (states) => {
      const found = states.flatMap((state) => state.bodies).find(({ body }) => body.name === name);
      return found ? found.position_m : [0, 0, 0];
    },
  };
}

function centreOfAll(states) {
  const extent = new Extent();
  for (const state of states) {
    for (const { body, position_m } of state.bodies) extent.take(...position_m, body.radius_m);
    for (const { points } of state.tethers) {
      for (let at = 0; at < points.length; at += 3) extent.take(points[at], points[at + 1], points[at + 2]);
    }
  }
  return extent.centre();
}

/** Sets how much a camera sees, so that a cage of half this size about its target is in the picture. */
function fit(camera, half_m) {
  const { right, up } = camera.axes();
  let [across_m, along_m] = [0, 0];
  for (const corner of cornersOf({ low: half_m.map((half) => -half), high: half_m })) {
    across_m = Math.max(across_m, Math.abs(dot(right, corner)));
    along_m = Math.max(along_m, Math.abs(dot(up, corner)));
  }
  // Room for numbers and names of axes about the cage, in pixels.
  const width = Math.max(camera.size[0] - 170, 0.4 * camera.size[0]);
  const height = Math.max(camera.size[1] - 110, 0.4 * camera.size[1]);
  camera.height_m = 2 * camera.size[1] * Math.max(along_m / height, across_m / width);
  if (camera.isPerspective) camera.height_m *= 1.15;
}
