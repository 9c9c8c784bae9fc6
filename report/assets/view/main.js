// The view of a section: runs, camera, time, and one picture after the other where something has changed.

class View {
  constructor(section) {
    const { origin_m, runs } = readRuns(section.querySelector('.view-data').textContent);
    this.section = section;
    this.origin_m = origin_m;
    this.runs = runs;
    this.options = {};
    this.pictures = 0;
    this.camera = new Camera();
    const { looks, first } = looksOf(runs);
    [this.looks, this.look] = [looks, first];
    this.pan_m = [0, 0, 0];
    this.isFitted = true;
    this.player = new Player(runs, () => this.onTime());
    this.events = runs.flatMap((run) => run.events.map(([time_s, text]) => (
      { time_s, text: runs.length > 1 ? `${run.name}: ${text}` : text }))).sort((a, b) => a.time_s - b.time_s);
    const scale = tensionScale(runs);
    this.scene = new Scene(runs, scale);
    this.overlay = new Overlay(section, runs, (key) => this.lookAt(key));
    this.legend = buildLegend(section.querySelector('.view-legend'), runs, scale, () => this.redraw());
    this.controls = bindControls(section, this);
    this.controls.look.value = this.look.key;
    this.fastest_m_s = { wind: fastestAir(runs, false), relative: fastestAir(runs, true), none: 0 };
    addEventTicks(section, this.events, this.player);
    this.set('arrows', this.options.arrows);
    this.bindCanvas();
    this.onTime();
  }

  bindCanvas() {
    this.stage = this.section.querySelector('.view-stage');
    this.canvas = this.section.querySelector('.view-canvas');
    if (this.runs.length === 0) {
      this.say('Nothing was recorded that could be shown.');
      return;
    }
    this.drawing = Drawing.on(this.canvas);
    if (!this.drawing) {
      this.say('The 3-D view needs WebGL2, which this browser does not have or has turned off. '
        + 'Figures and numbers are complete without it.');
      return;
    }
    this.canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.drawing = undefined;
    });
    this.canvas.addEventListener('webglcontextrestored', () => {
      this.drawing = Drawing.on(this.canvas);
      this.redraw();
    });
    new ResizeObserver(() => this.redraw()).observe(this.stage);
    window.addEventListener('resize', () => this.redraw());
  }

  /** A sentence in place of the picture. */
  say(sentence) {
    this.stage.replaceChildren(node('p', 'view-none', sentence));
  }

  /** Sets what is shown. */
  set(name, value) {
    this.options[name] = value;
    if (name === 'arrows') {
      const fastest_m_s = this.fastest_m_s[value];
      this.options.arrowMost_m_s = niceAbove(fastest_m_s);
      tellArrows(this.legend.arrows, value, fastest_m_s, this.options.arrowMost_m_s);
    }
    if (name === 'perspective') this.camera.isPerspective = value;
    this.redraw();
  }

  lookAt(key) {
    const look = this.looks.find((it) => it.key === key);
    if (!look) return;
    this.look = look;
    this.controls.look.value = key;
    this.pan_m = [0, 0, 0];
    this.isFitted = true;
    this.redraw();
  }

  /** Looks from a direction at all of what is looked at. */
  lookAlong(direction) {
    [this.camera.azimuth, this.camera.elevation] = DIRECTIONS[direction];
    this.lookAt(this.look.key);
  }

  reset() {
    this.lookAlong('first');
  }

  /** Looks at the body nearest to a place in the picture. */
  lookAtPlace(x, y) {
    let best = { distance: 25 };
    for (const { body, position_m } of this.states().flatMap((state) => state.bodies)) {
      const at = this.camera.project(position_m);
      if (!at) continue;
      const distance = Math.hypot(at.x - x, at.y - y) - 0.7 * body.radius_m * at.scale;
      if (distance < best.distance) best = { distance, key: `body:${body.name}` };
    }
    if (best.key) this.lookAt(best.key);
  }

  turn(dx, dy) {
    this.camera.turn(dx, dy);
    this.redraw();
  }

  drag(dx, dy) {
    this.pan_m = plus(this.pan_m, this.camera.drag_m(dx, dy));
    this.isFitted = false;
    this.redraw();
  }

  zoom(factor, x, y) {
    this.pan_m = plus(this.pan_m, this.camera.zoom(factor, x, y));
    this.isFitted = false;
    this.redraw();
  }

  states() {
    return this.runs.filter((run) => run.shown).map((run) => stateOf(run, this.player.time_s));
  }

  /** Shows the time and tells it. */
  onTime() {
    const { player, controls } = this;
    if (!controls) return;
    const { time_s } = player;
    controls.time.value = time_s;
    controls.shown.value = `${secondsText(time_s, player)} s`;
    controls.play.textContent = player.isPlaying ? '\u275a\u275a' : '\u25b6';
    controls.play.setAttribute('aria-label', player.isPlaying ? 'pause' : 'play');
    const passed = this.events.filter((event) => event.time_s <= time_s + 1e-9).at(-1);
    const text = passed ? `${secondsText(passed.time_s, player)} s: ${passed.text}` : '';
    if (controls.event.textContent !== text) controls.event.textContent = text;
    if (this.told_s !== time_s) {
      this.told_s = time_s;
      document.dispatchEvent(new CustomEvent('aerobot:time', { detail: { time_s } }));
    }
    this.redraw();
  }

  /** Asks for a picture. */
  redraw() {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame((now_ms) => {
      this.isAsked = false;
      this.player.advance(now_ms);
      this.draw();
    });
  }

  draw() {
    const size = [this.stage?.clientWidth ?? 0, this.stage?.clientHeight ?? 0];
    if (!this.drawing || !(size[0] > 0 && size[1] > 0)) return;
    const { camera, look, options } = this;
    const ratio = this.resize(size);
    const states = this.states();
    const centre_m = look.centre(states);
    camera.target_m = plus(centre_m, this.pan_m);
    if (this.isFitted) fit(camera, look.half_m);
    const { half_m } = look;
    const cage = this.isFitted ? cageAbout(camera, centre_m, half_m) : cageOf(camera, { centre_m, half_m });
    camera.reach_m = 2 * length(this.looks[0].half_m) + 2 * length(minus(camera.target_m, this.looks[0].centre(states)))
      + 2 * camera.height_m;
    const context = { options, cage, trailOf: look.body, time_s: this.player.time_s,
      origin_m: this.origin_m, lookedAt: look.body };
    this.scene.draw(this.drawing, camera, ratio, states, context);
    this.overlay.place(camera, states, context);
    this.pictures += 1;
  }

  /** Gives the canvas the pixels that it is shown with; tells how many there are for one of the page. */
  resize(size) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = size.map((pixels) => Math.round(pixels * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      [this.canvas.width, this.canvas.height] = [width, height];
    }
    this.camera.size = size;
    return ratio;
  }

  /** What programs outside may ask and tell. */
  door() {
    const { player, camera } = this;
    return {
      play: () => player.play(),
      pause: () => player.pause(),
      seek: (time_s) => player.seek(time_s),
      time: () => player.time_s,
      span: () => [player.start_s, player.end_s],
      isPlaying: () => player.isPlaying,
      framesDrawn: () => this.pictures,
      camera: () => ({
        azimuth: camera.azimuth,
        elevation: camera.elevation,
        height_m: camera.height_m,
        target_m: plus(camera.target_m, this.origin_m),
        isPerspective: camera.isPerspective,
        lookedAt: this.look.key,
      }),
      lookAt: (key) => this.lookAt(key),
      lookAlong: (direction) => this.lookAlong(direction),
      bodies: () => this.states().flatMap(({ run, bodies }) => bodies.map((it) => ({
        run: run.name,
        name: it.body.name,
        position_m: plus(it.position_m, this.origin_m),
        attitude: it.attitude,
        wind_m_s: it.wind_m_s,
      }))),
      project: (point_m) => camera.project(minus(point_m, this.origin_m)),
    };
  }
}

function start() {
  const section = document.querySelector('section.view');
  if (!section) return;
  const view = new View(section);
  document.addEventListener('aerobot:seek', (event) => view.player.seek(event.detail?.time_s));
  window.aerobotView = view.door();
}

if (document.readyState === 'loading') document.addEventListener('DOMContentLoaded', start);
else start();
