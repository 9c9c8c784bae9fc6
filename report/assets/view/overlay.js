// Texts over the picture: names of bodies, numbers of axes, the scale, the directions of the axes.

const SVG = 'http://www.w3.org/2000/svg';
/** Where a name may stand from its body, in pixels: the first that is free is taken. */
const BESIDE = [[9, -23], [-9, -23], [9, 5], [-9, 5], [11, -9], [-11, -9], [9, -42], [-9, -42], [9, 24], [-9, 24]];
const NAME_HEIGHT = 18;

class Overlay {
  constructor(section, runs, onLook) {
    this.layer = section.querySelector('.view-overlay');
    this.triad = triadOf(section.querySelector('.view-triad'));
    this.scaleBar = section.querySelector('.view-scale-bar');
    this.scaleText = section.querySelector('.view-scale-text');
    this.ticks = [];
    this.names = new Map();
    const first = new Set(runs[0]?.bodies.map((body) => body.name));
    for (const run of runs) {
      for (const { name } of run.bodies) {
        const element = document.createElement('button');
        element.type = 'button';
        element.tabIndex = -1;
        element.className = 'view-name';
        element.textContent = run.index > 0 && first.has(name) ? `${name} (${run.name})` : name;
        element.style.borderColor = css(RUNS[run.index % RUNS.length]);
        element.addEventListener('click', () => onLook(`body:${name}`));
        this.layer.append(element);
        this.names.set(keyOf(run, name), { element, width: 0 });
      }
    }
  }

  /** Puts the texts where they belong in this picture. */
  place(camera, states, { options, cage, origin_m, lookedAt }) {
    this.placeNames(camera, states, options, lookedAt);
    this.placeTicks(options.grid ? ticksOf(cage, camera, origin_m) : []);
    this.placeScale(camera);
    turnTriad(this.triad, camera);
  }

  placeNames(camera, states, options, lookedAt) {
    const wanted = [];
    const firstPlaces = new Map();
    for (const entry of this.names.values()) entry.at = undefined;
    for (const { run, bodies } of states) {
      for (const { body, position_m } of bodies) {
        const at = camera.project(position_m);
        if (!at || !isInside(at, camera.size)) continue;
        const other = firstPlaces.get(body.name);
        // A body of another run that lies over that of the first needs no name of its own.
        if (other && Math.hypot(at.x - other.x, at.y - other.y) < 30) continue;
        firstPlaces.set(body.name, at);
        const radius = Math.max(body.radius_m * at.scale, 0);
        wanted.push({ key: keyOf(run, body.name), at, radius, isFirst: body.name === lookedAt });
      }
    }
    wanted.sort((a, b) => Number(b.isFirst) - Number(a.isFirst));
    const taken = wanted.map(({ at, radius }) => {
      const half = clamp(0.6 * radius, 6, 60);
      return box(at.x - half, at.y - half, 2 * half, 2 * half);
    });
    if (options.labels) for (const want of wanted) this.placeName(want, taken, camera.size);
    for (const { element, at } of this.names.values()) {
      element.style.visibility = at ? 'visible' : 'hidden';
      if (at) element.style.transform = `translate(${at.x.toFixed(1)}px,${at.y.toFixed(1)}px)`;
    }
  }

  placeName({ key, at, radius, isFirst }, taken, size) {
    const entry = this.names.get(key);
    entry.width ||= entry.element.offsetWidth;
    // Beside a large body the name is at its rim, seen at 45 degrees.
    const rim = radius < SMALL_PIXELS ? 0 : Math.min(0.7 * radius, 0.3 * size[1]);
    for (const [dx, dy] of BESIDE) {
      const x = at.x + dx + (dx > 0 ? rim : -rim - entry.width);
      const y = at.y + dy + (dy < 0 ? -rim : rim) * (rim > 0 ? 1 : 0);
      const own = box(x, y, entry.width, NAME_HEIGHT);
      const inside = x > 0 && x + entry.width < size[0] && y > 0 && y + NAME_HEIGHT < size[1];
      if (inside && !taken.some((other) => overlap(own, other))) {
        taken.push(own);
        entry.at = { x, y };
        return;
      }
    }
    if (isFirst) entry.at = { x: at.x + 9, y: at.y - 23 };
  }

  placeTicks(ticks) {
    while (this.ticks.length < ticks.length) {
      const element = document.createElement('span');
      element.className = 'view-tick';
      this.layer.append(element);
      this.ticks.push(element);
    }
    this.ticks.forEach((element, index) => {
      const tick = ticks[index];
      element.style.visibility = tick ? 'visible' : 'hidden';
      if (!tick) return;
      if (element.textContent !== tick.text) element.textContent = tick.text;
      element.classList.toggle('view-axis', tick.isName === true);
      element.style.transform =
        `translate(${tick.x.toFixed(1)}px,${tick.y.toFixed(1)}px) translate(${tick.align}%,${tick.vertical}%)`;
    });
  }

  placeScale(camera) {
    const metres = niceAbove(60 / camera.pixelsPerMetre());
    this.scaleBar.style.width = `${(metres * camera.pixelsPerMetre()).toFixed(1)}px`;
    const text = metres >= 1000 ? `${metres / 1000} km` : `${decimals(metres, metres)} m`;
    if (this.scaleText.textContent !== text) this.scaleText.textContent = text;
  }
}

function keyOf(run, name) {
  return `${run.index}/${name}`;
}

function isInside({ x, y }, [width, height]) {
  return x >= 0 && y >= 0 && x <= width && y <= height;
}

function box(x, y, width, height) {
  return { x, y, width, height };
}

function overlap(a, b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/** Three lines with letters in a small picture of their own. */
function triadOf(svg) {
  return ['x', 'y', 'z'].map((letter, k) => {
    const line = document.createElementNS(SVG, 'line');
    line.setAttribute('stroke', css(AXES[k]));
    line.setAttribute('stroke-width', '2.5');
    const text = document.createElementNS(SVG, 'text');
    text.textContent = letter;
    text.setAttribute('fill', css(AXES[k]));
    text.setAttribute('text-anchor', 'middle');
    text.setAttribute('dominant-baseline', 'central');
    svg.append(line, text);
    return { line, text };
  });
}

function turnTriad(triad, camera) {
  const { right, up } = camera.axes();
  triad.forEach(({ line, text }, k) => {
    const [x, y] = [24 * right[k], -24 * up[k]];
    line.setAttribute('x2', x.toFixed(1));
    line.setAttribute('y2', y.toFixed(1));
    const short = Math.hypot(x, y) < 6;
    text.setAttribute('x', (short ? -9 : 1.4 * x).toFixed(1));
    text.setAttribute('y', (short ? 9 : 1.4 * y).toFixed(1));
  });
}
