// The camera: it looks at a target from a direction, and sees so many metres from bottom to top.

/** Field of view from bottom to top in perspective, rad. */
const FIELD = 0.5;
const UPRIGHT = Math.PI / 2;

/** Directions of the eye from the target: azimuth from x to y, elevation, rad. */
const DIRECTIONS = {
  first: [-1.05, 0.22],
  side: [-UPRIGHT, 0],
  front: [-2 * UPRIGHT, 0],
  top: [-UPRIGHT, UPRIGHT],
};

class Camera {
  constructor() {
    this.target_m = [0, 0, 0];
    [this.azimuth, this.elevation] = DIRECTIONS.first;
    this.height_m = 10;
    this.reach_m = 100;
    this.isPerspective = false;
    this.size = [1, 1];
  }

  /** Unit vectors to the right, up, and from the target to the eye. */
  axes() {
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    return { right: [-sa, ca, 0], up: [-se * ca, -se * sa, ce], toEye: [ce * ca, ce * sa, se] };
  }

  aspect() {
    return this.size[0] / this.size[1];
  }

  /** Distance of the eye, m, in perspective. */
  distance_m() {
    return (0.5 * this.height_m) / Math.tan(0.5 * FIELD);
  }

  /** Least w of what is drawn. */
  nearest() {
    return this.isPerspective ? 0.01 * this.distance_m() : 0.5;
  }

  /** From metres relative to the target to clip space, by columns. */
  matrix() {
    const { right, up, toEye } = this.axes();
    const d = this.isPerspective ? this.distance_m() : 1;
    const sx = (2 * d) / (this.height_m * this.aspect());
    const sy = (2 * d) / this.height_m;
    let rows;
    if (this.isPerspective) {
      const [near, far] = [this.nearest(), d + this.reach_m];
      const a = (far + near) / (far - near);
      const b = (2 * far * near) / (far - near);
      rows = [[...right.map((v) => sx * v), 0], [...up.map((v) => sy * v), 0],
        [...toEye.map((v) => -a * v), a * d - b], [...toEye.map((v) => -v), d]];
    } else {
      rows = [[...right.map((v) => sx * v), 0], [...up.map((v) => sy * v), 0],
        [...toEye.map((v) => -v / this.reach_m), 0], [0, 0, 0, 1]];
    }
    return new Float32Array([0, 1, 2, 3].flatMap((column) => rows.map((row) => row[column])));
  }

  /** Where a point is in the picture, in pixels of the page from its top left; nothing behind the eye. */
  project(point_m) {
    const { right, up, toEye } = this.axes();
    const at = minus(point_m, this.target_m);
    const depth_m = dot(toEye, at);
    let scale = this.size[1] / this.height_m;
    if (this.isPerspective) {
      const d = this.distance_m();
      if (depth_m > 0.99 * d) return undefined;
      scale *= d / (d - depth_m);
    }
    return {
      x: 0.5 * this.size[0] + scale * dot(right, at),
      y: 0.5 * this.size[1] - scale * dot(up, at),
      scale,
    };
  }

  /** Pixels of the page for a metre at the target. */
  pixelsPerMetre() {
    return this.size[1] / this.height_m;
  }

  turn(dx, dy) {
    this.azimuth -= 0.008 * dx;
    this.elevation = clamp(this.elevation + 0.008 * dy, -UPRIGHT, UPRIGHT);
  }

  /** Metres that the target moves for a drag of so many pixels. */
  drag_m(dx, dy) {
    const { right, up } = this.axes();
    const metres = 1 / this.pixelsPerMetre();
    return plus(plus([0, 0, 0], right, -dx * metres), up, dy * metres);
  }

  /** Sees so many times more, and keeps the point under the pointer where it is; tells by what the target moves. */
  zoom(factor, x, y) {
    const before_m = this.height_m;
    this.height_m = clamp(this.height_m * factor, 0.02, 1e7);
    const { right, up } = this.axes();
    const change = (before_m - this.height_m) / this.size[1];
    const [dx, dy] = [x - 0.5 * this.size[0], 0.5 * this.size[1] - y];
    return plus(plus([0, 0, 0], right, change * dx), up, change * dy);
  }
}
