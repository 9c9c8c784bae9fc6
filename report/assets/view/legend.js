// The legend: tensions, what colours mean, the scale of arrows, runs.

/** Builds the legend; `onRuns` is called when a run is shown or hidden. */
function buildLegend(element, runs, scale, onRuns) {
  if (runs.length > 1) element.append(runsLegend(runs, onRuns));
  if (scale) element.append(tensionLegend(scale));
  element.append(rolesLegend(runs));
  const arrows = block('');
  element.append(arrows);
  return { arrows };
}

/** An element with a class and children. */
function node(name, className, ...children) {
  const element = document.createElement(name);
  element.className = className;
  element.append(...children);
  return element;
}

function block(title) {
  const element = node('div', 'view-block');
  if (title) element.append(node('div', 'view-title', title));
  return element;
}

function runsLegend(runs, onRuns) {
  const element = block('runs');
  for (const run of runs) {
    const input = document.createElement('input');
    input.type = 'checkbox';
    input.checked = true;
    input.addEventListener('change', () => {
      run.shown = input.checked;
      onRuns();
    });
    const swatch = node('span', 'view-ring');
    swatch.style.borderColor = css(RUNS[run.index % RUNS.length]);
    const how = run.index === 0 ? '' : ' (translucent, dashed)';
    element.append(node('label', 'view-entry', input, swatch, `${run.name}${how}`));
  }
  return element;
}

function tensionLegend(scale) {
  const element = block('tension [N]');
  const bar = node('div', 'view-bar');
  const stops = Array.from({ length: 17 }, (_, index) => css(ofRange(index / 16)));
  bar.style.background = `linear-gradient(to top, ${stops.join(',')})`;
  const numbers = node('div', 'view-numbers');
  const count = Math.round((scale.most_n - scale.least_n) / scale.step_n);
  for (let index = 0; index <= count; index += 1) {
    const value = scale.least_n + index * scale.step_n;
    const part = (value - scale.least_n) / (scale.most_n - scale.least_n);
    if (part > 1.001) continue;
    const number = node('span', '', decimals(value, scale.step_n));
    number.style.bottom = `${(100 * part).toFixed(2)}%`;
    numbers.append(number);
  }
  element.append(node('div', 'view-scale-of-tension', bar, numbers));
  element.append(entry(css(SLACK), 'slack (0 N)', 'view-line'));
  return element;
}

function entry(colour, text, className = 'view-swatch') {
  const swatch = node('span', className);
  swatch.style.background = colour;
  return node('div', 'view-entry', swatch, text);
}

function rolesLegend(runs) {
  const element = block('bodies');
  const parts = runs.flatMap((run) => run.bodies.flatMap((body) => body.parts));
  for (const [role, { colour, name }] of Object.entries(ROLES)) {
    if (parts.some((part) => part.role === role)) element.append(entry(css(colour), name));
  }
  if (parts.some((part) => !part.to_scale)) {
    element.append(node('div', 'view-entry', node('span', 'view-swatch view-hatched'), 'not to scale'));
  }
  if (parts.length > 0) element.append(node('div', 'view-entry', node('span', 'view-ring'), 'too small to see'));
  return element;
}

/** Tells the scale of the arrows: `most_m_s` is as long as the longest. */
function tellArrows(element, arrows, fastest_m_s, most_m_s) {
  element.replaceChildren();
  if (arrows === 'none') return;
  const title = arrows === 'relative' ? 'air past the body' : 'wind';
  element.append(node('div', 'view-title', title));
  if (fastest_m_s === 0) {
    element.append(node('div', 'view-entry', 'none'));
    return;
  }
  const arrow = node('span', 'view-arrow');
  arrow.style.width = `${ARROW_PIXELS}px`;
  element.append(node('div', 'view-entry view-stacked', arrow, `${decimals(most_m_s, most_m_s / 10)} m/s`));
}
