// What is drawn of the runs: solids, tethers, trails, arrows of the air, rings about what is too small to see.

/** Widths of lines, pixels. */
const TETHER_PIXELS = 3;
const RING_PIXELS = 12;
/** A body whose radius in the picture is below this has a ring. */
const SMALL_PIXELS = 9;
/** Length of the longest arrow, pixels. */
const ARROW_PIXELS = 90;
const TRAIL_POINTS = 500;

class Scene {
  constructor(runs, scale) {
    this.runs = runs;
    this.scale = scale;
    this.behind = new Lines();
    this.there = new Lines();
    this.front = new Lines();
  }

  /** Draws the states of the runs that are shown. */
  draw(drawing, camera, ratio, states, { options, cage, origin_m, trailOf, time_s }) {
    this.behind.clear();
    this.there.clear();
    this.front.clear();
    this.camera = camera;
    drawing.begin(camera, ratio);
    if (options.grid) addGrid(this.behind, cage, camera, origin_m);
    const solids = [];
    for (const state of states) {
      this.addTethers(state);
      if (options.trails) this.addTrails(state, trailOf, time_s);
    }
    // The first run lies over the others.
    for (const state of [...states].reverse()) {
      for (const body of state.bodies) this.addBody(state, body, options, solids);
    }
    drawing.lines(this.behind, 'behind');
    for (const solid of solids.filter((it) => it.opacity === 1)) drawing.solid(solid);
    drawing.lines(this.there, 'there');
    for (const solid of solids.filter((it) => it.opacity < 1)) drawing.solid(solid);
    drawing.lines(this.front, 'front');
  }

  /** A point relative to the target, in which single precision is enough. */
  relative(points, at = 0) {
    const { target_m } = this.camera;
    return [points[at] - target_m[0], points[at + 1] - target_m[1], points[at + 2] - target_m[2]];
  }

  addTethers({ run, tethers }) {
    const opacity = run.index === 0 ? 1 : 0.75;
    const dash = run.index === 0 ? 0 : 5;
    for (const { tether, points, tensions } of tethers) {
      const width = Math.max(TETHER_PIXELS, tether.diameter_m * this.camera.pixelsPerMetre());
      for (let index = 0; index < tensions.length; index += 1) {
        if (Number.isNaN(tensions[index])) continue;
        const colour = ofTension(tensions[index], this.scale);
        const [from, to] = [this.relative(points, 3 * index), this.relative(points, 3 * index + 3)];
        this.there.add(from, to, colour, opacity, width, dash);
      }
    }
  }

  addTrails({ run, place, bodies }, trailOf, time_s) {
    const every = Math.max(1, Math.ceil(place.frame / TRAIL_POINTS));
    for (const { body, position_m } of bodies) {
      if (trailOf !== undefined && body.name !== trailOf) continue;
      const colour = ROLES[body.parts[0].role].colour;
      let from = this.relative(body.positions_m, 0);
      for (let frame = every; frame <= place.frame; frame += every) {
        const to = this.relative(body.positions_m, 3 * frame);
        this.there.add(from, to, colour, 0.55, 1.6, run.index === 0 ? 0 : 4);
        from = to;
      }
      if (time_s > run.times_s[0]) this.there.add(from, this.relative(position_m), colour, 0.55, 1.6);
    }
  }

  addBody({ run }, state, options, solids) {
    const { body, position_m, attitude } = state;
    const at = this.camera.project(position_m);
    if (!at) return;
    const centre = this.relative(position_m);
    const radius = body.radius_m * at.scale;
    if (radius > 0.7) {
      for (const part of body.parts) solids.push(solidOf(part, centre, attitude, run.index > 0));
    }
    if (radius < SMALL_PIXELS) {
      const colour = ROLES[body.parts[0].role].colour;
      const ring = RING_PIXELS + (run.index === 0 ? 0 : 5);
      this.front.add(centre, centre, RUNS[run.index % RUNS.length], 0.9, ring);
      this.front.add(centre, centre, [1, 1, 1], 1, ring - 3);
      this.front.add(centre, centre, colour, run.index === 0 ? 1 : 0.6, RING_PIXELS - 6);
    } else if (options.axes) {
      const reach_m = body.radius_m + 14 / at.scale;
      AXES.forEach((colour, k) => {
        const axis = [0, 0, 0];
        axis[k] = reach_m;
        this.front.add(centre, plus(centre, turned(attitude, axis)), colour, 0.9, 1.8);
      });
    }
    if (options.arrows !== 'none') this.addArrow(centre, at.scale, state, options);
  }

  addArrow(centre, pixelsPerMetre, { wind_m_s, velocity_m_s }, { arrows, arrowMost_m_s }) {
    const air = arrows === 'relative' ? minus(wind_m_s, velocity_m_s) : wind_m_s;
    const speed = length(air);
    const pixels = (ARROW_PIXELS * speed) / arrowMost_m_s;
    if (!(pixels > 2)) return;
    const long = pixels / pixelsPerMetre;
    const tip = plus(centre, air, long / speed);
    this.front.add(centre, tip, WIND, 0.9, 2);
    const { toEye } = this.camera.axes();
    const way = air.map((value) => value / speed);
    const side = cross(way, toEye);
    const norm = length(side);
    if (norm < 0.05) return;
    const head = Math.min(8, 0.5 * pixels) / pixelsPerMetre;
    for (const turn of [-0.45, 0.45]) {
      const back = plus(plus(tip, way, -head), side, (turn * head) / norm);
      this.front.add(tip, back, WIND, 0.9, 2);
    }
  }
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** A part as it is drawn: another run than the first is translucent. */
function solidOf({ solid, at_m, role, to_scale }, centre, attitude, isOther) {
  const size = {
    sphere: () => [solid.radius_m, solid.radius_m, solid.radius_m],
    box: () => solid.size_m,
    cylinder: () => [solid.radius_m, solid.radius_m, solid.height_m],
  }[solid.kind]();
  const own = ROLES[role].colour;
  const opacity = role === 'balloon' ? 0.5 : 1;
  return {
    kind: solid.kind,
    size,
    centre: plus(centre, turned(attitude, at_m)),
    attitude,
    colour: to_scale ? own : NOT_TO_SCALE,
    opacity: isOther ? 0.4 * opacity : opacity,
    hatched: !to_scale,
  };
}

/** The fastest air of all bodies and runs, m/s, and past them. */
function fastestAir(runs, isRelative) {
  let most = 0;
  for (const run of runs) {
    for (const body of run.bodies) {
      for (let frame = 0; frame < run.times_s.length; frame += 1) {
        const place = { frame, part: 0 };
        const air = between(body.wind_m_s, place);
        const past = isRelative ? minus(air, velocityAt(run, body, place)) : air;
        most = Math.max(most, length(past));
      }
    }
  }
  return most;
}
