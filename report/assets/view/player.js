// The time that is shown, and how it goes on.

/** How long the whole takes at the speed of the beginning, s. */
const WHOLE_S = 20;
/** No jump of a clock is longer than this, ms. */
const LONGEST_STEP_MS = 250;

class Player {
  /** For runs; `onChange` is called whenever the time shown or the state of playing changes. */
  constructor(runs, onChange) {
    this.times_s = Float64Array.from(runs.flatMap((run) => [...run.times_s])).sort();
    this.start_s = this.times_s[0] ?? 0;
    this.end_s = this.times_s[this.times_s.length - 1] ?? 0;
    this.time_s = this.start_s;
    this.speeds = speedsFor(this.end_s - this.start_s);
    const off = (speed) => Math.abs(Math.log((speed * WHOLE_S) / this.span_s()));
    this.speed = this.speeds.reduce((best, it) => (off(it) < off(best) ? it : best));
    this.isPlaying = false;
    this.isLooping = true;
    this.onChange = onChange;
  }

  span_s() {
    return Math.max(this.end_s - this.start_s, 1e-9);
  }

  play() {
    if (this.isPlaying || this.end_s <= this.start_s) return;
    if (this.time_s >= this.end_s) this.time_s = this.start_s;
    this.isPlaying = true;
    this.last_ms = undefined;
    this.onChange();
  }

  pause() {
    this.isPlaying = false;
    this.onChange();
  }

  toggle() {
    if (this.isPlaying) this.pause();
    else this.play();
  }

  seek(time_s) {
    if (!Number.isFinite(time_s)) return;
    const wanted_s = clamp(time_s, this.start_s, this.end_s);
    if (wanted_s === this.time_s) return;
    this.time_s = wanted_s;
    this.onChange();
  }

  /** To the next frame of any run, or to the one before. */
  step(direction) {
    this.isPlaying = false;
    const later = this.times_s.find((time_s) => time_s > this.time_s + 1e-9) ?? this.end_s;
    const earlier = this.times_s.findLast((time_s) => time_s < this.time_s - 1e-9) ?? this.start_s;
    this.time_s = direction > 0 ? later : earlier;
    this.onChange();
  }

  /** Goes on by the time since the last picture, by a clock in ms. */
  advance(now_ms) {
    if (!this.isPlaying) return;
    const passed_ms = Math.min(now_ms - (this.last_ms ?? now_ms), LONGEST_STEP_MS);
    this.last_ms = now_ms;
    const next_s = this.time_s + (this.speed * Math.max(passed_ms, 0)) / 1000;
    if (next_s < this.end_s) this.time_s = next_s;
    else if (this.isLooping && this.time_s >= this.end_s) this.time_s = this.start_s;
    else this.time_s = this.end_s;
    if (this.time_s >= this.end_s && !this.isLooping) this.isPlaying = false;
    this.onChange();
  }
}

/** Speeds to choose from: a tenth to a hundred times real time, and more for long runs. */
function speedsFor(span_s) {
  const speeds = [];
  const fastest = Math.max(100, niceAbove(span_s / WHOLE_S));
  for (let decade = 0.1; decade <= fastest; decade *= 10) {
    for (const factor of [1, 2, 5]) {
      const speed = Number((factor * decade).toPrecision(3));
      if (speed <= fastest * 1.001) speeds.push(speed);
    }
  }
  return speeds;
}
