// What is looked at: the whole of it, everything as it moves along, or a body; and how large that is.

/** Half of what is seen about a body, in its radii, and at least in metres. */
const ABOUT_A_BODY = 4;
const LEAST_HALF_M = 1.5;

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
    { key: 'whole', name: 'whole', half_m: whole.half(), centre: () => whole.centre() },
    { key: 'moving', name: 'whole, moving along', half_m: moving_m, centre: centreOfAll },
  ];
  const names = new Set(runs.flatMap((run) => run.bodies.map((body) => body.name)));
  for (const name of names) looks.push(bodyLook(runs, name));
  // Where the system leaves its own place by far, one sees more of it from a camera that goes with it.
  const travels = Math.max(...whole.half()) > 2.5 * Math.max(...moving_m);
  return { looks, first: looks[travels ? 1 : 0] };
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
function fit(camera, half_m, origin_m) {
  camera.height_m = 4 * Math.max(...half_m, 0.1);
  for (let round = 0; round < 4; round += 1) {
    const cage = cageOf(camera, { centre_m: camera.target_m, half_m }, origin_m);
    const { right, up } = camera.axes();
    let [across, along] = [0, 0];
    for (const corner of cornersOf(cage)) {
      const at = minus(corner, camera.target_m);
      across = Math.max(across, Math.abs(dot(right, at)));
      along = Math.max(along, Math.abs(dot(up, at)));
    }
    // Room for names of axes, in pixels, about the cage.
    const [width, height] = camera.size.map((pixels) => Math.max(pixels - 150, 0.4 * pixels));
    camera.height_m = 2 * camera.size[1] * Math.max(along / height, across / width);
    if (camera.isPerspective) camera.height_m *= 1.15;
  }
}
