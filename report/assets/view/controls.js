// Pointer, wheel, keys and what stands around the picture.

/** Binds the controls of a section to a view. */
function bindControls(section, view) {
  const control = (name) => section.querySelector(`[data-view="${name}"]`);
  const look = control('look');
  look.append(...view.looks.map(({ key, name }) => new Option(name, key)));
  look.addEventListener('change', () => view.lookAt(look.value));
  for (const button of section.querySelectorAll('[data-view-along]')) {
    button.addEventListener('click', () => view.lookAlong(button.dataset.viewAlong));
  }
  control('reset').addEventListener('click', () => view.reset());
  control('arrows').addEventListener('change', (event) => view.set('arrows', event.target.value));
  for (const name of ['labels', 'trails', 'axes', 'grid', 'perspective']) {
    // A browser may keep what was chosen before the page was loaded again.
    view.options[name] = control(name).checked;
    control(name).addEventListener('change', (event) => view.set(name, event.target.checked));
  }
  view.options.arrows = control('arrows').value || 'wind';
  bindPlayer(section, control, view.player);
  bindPointer(section.querySelector('.view-stage'), view);
  section.addEventListener('keydown', (event) => onKey(event, view.player));
  return { look, time: control('time'), play: control('play'), shown: section.querySelector('.view-time'),
    event: section.querySelector('.view-event') };
}

function bindPlayer(section, control, player) {
  control('play').addEventListener('click', () => player.toggle());
  control('back').addEventListener('click', () => player.step(-1));
  control('forth').addEventListener('click', () => player.step(1));
  const time = control('time');
  [time.min, time.max, time.value] = [player.start_s, player.end_s, player.time_s];
  time.addEventListener('input', () => player.seek(Number(time.value)));
  const speed = control('speed');
  speed.append(...player.speeds.map((it) => new Option(`${it}\u00d7`, it)));
  speed.value = String(player.speed);
  speed.addEventListener('change', () => {
    player.speed = Number(speed.value);
  });
  player.isLooping = control('loop').checked;
  control('loop').addEventListener('change', (event) => {
    player.isLooping = event.target.checked;
  });
}

/** Ticks of events on the slider. */
function addEventTicks(section, events, player) {
  const ticks = section.querySelector('.view-ticks');
  for (const { time_s, text } of events) {
    const tick = node('button', 'view-event-tick');
    tick.type = 'button';
    tick.tabIndex = -1;
    tick.title = `${secondsText(time_s, player)} s: ${text}`;
    tick.style.left = `${(100 * (time_s - player.start_s)) / player.span_s()}%`;
    tick.addEventListener('click', () => player.seek(time_s));
    ticks.append(tick);
  }
}

/** A time with as many decimals as the length of the run lets one see. */
function secondsText(time_s, player) {
  return decimals(time_s, clamp(player.span_s() / 5000, 0.001, 1));
}

function onKey(event, player) {
  const { target, key } = event;
  if (event.ctrlKey || event.metaKey || event.altKey || target.tagName === 'SELECT') return;
  // A button or a box does with the space key what it does.
  const isSlider = target.type === 'range';
  if (key === ' ' && (isSlider || !['BUTTON', 'INPUT'].includes(target.tagName))) player.toggle();
  else if (key === 'ArrowRight') player.step(1);
  else if (key === 'ArrowLeft') player.step(-1);
  else if (key === 'Home') player.seek(player.start_s);
  else if (key === 'End') player.seek(player.end_s);
  else return;
  event.preventDefault();
}

/** Drag, wheel and double click. */
function bindPointer(stage, view) {
  let held;
  stage.addEventListener('pointerdown', (event) => {
    if (event.target.closest('.view-name')) return;
    const moves = event.button !== 0 || event.shiftKey;
    held = { x: event.clientX, y: event.clientY, moves };
    stage.setPointerCapture(event.pointerId);
    stage.focus({ preventScroll: true });
    event.preventDefault();
  });
  stage.addEventListener('pointermove', (event) => {
    if (!held) return;
    const [dx, dy] = [event.clientX - held.x, event.clientY - held.y];
    [held.x, held.y] = [event.clientX, event.clientY];
    if (held.moves) view.drag(dx, dy);
    else view.turn(dx, dy);
  });
  for (const name of ['pointerup', 'pointercancel']) {
    stage.addEventListener(name, () => {
      held = undefined;
    });
  }
  stage.addEventListener('contextmenu', (event) => event.preventDefault());
  stage.addEventListener('dblclick', (event) => {
    if (!event.target.closest('.view-name')) view.lookAtPlace(...placeIn(stage, event));
  });
  stage.addEventListener('wheel', (event) => {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : 30;
    view.zoom(Math.exp(clamp(0.0015 * lines * event.deltaY, -0.7, 0.7)), ...placeIn(stage, event));
  }, { passive: false });
}

function placeIn(stage, event) {
  const frame = stage.getBoundingClientRect();
  return [event.clientX - frame.left - stage.clientLeft, event.clientY - frame.top - stage.clientTop];
}
