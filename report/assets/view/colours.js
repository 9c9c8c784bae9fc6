// Colours: of tensions, of what a part is, of runs. Red, green, blue (and opacity) from 0 to 1.

// Viridis (van der Walt and Smith 2015), every sixteenth of its first 80 %: even in lightness, readable with
// every kind of colour blindness. It is turned round, so that much is dark on white, and its pale end is left off.
const VIRIDIS = ['440154', '471365', '482475', '463480', '414487', '3b528b', '355f8d', '2f6c8e', '2a788e',
  '25848e', '21918c', '1e9c89', '22a884', '2fb47c', '44bf70', '5ec962', '7ad151'].map(rgb);

const SLACK = rgb('b4b4b4');
const NOT_TO_SCALE = rgb('9a9a9a');

const ROLES = {
  balloon: { colour: rgb('e0a030'), name: 'balloon' },
  body: { colour: rgb('6d8296'), name: 'body' },
  sail: { colour: rgb('2f6fb5'), name: 'sail' },
  drone: { colour: rgb('c2502f'), name: 'drone' },
  anchor: { colour: rgb('3a3a3a'), name: 'anchor' },
};

/** Rings about bodies, by run. */
const RUNS = [rgb('1b1b1b'), rgb('c23b22'), rgb('2f6fb5'), rgb('3f8f5f')];

const WIND = rgb('b8307f');
const AXES = [rgb('c8332b'), rgb('2e8b3d'), rgb('2b55c8')];

function rgb(text) {
  return [0, 2, 4].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);
}

function css(colour) {
  return `rgb(${colour.map((part) => Math.round(255 * part)).join(',')})`;
}

/** Colour of a part of the range, from 0 to 1. */
function ofRange(part) {
  const place = (1 - clamp(part, 0, 1)) * (VIRIDIS.length - 1);
  const index = Math.min(Math.floor(place), VIRIDIS.length - 2);
  const rest = place - index;
  return VIRIDIS[index].map((from, k) => from + rest * (VIRIDIS[index + 1][k] - from));
}

/** Colour of a tension, N, on a scale from `least_n` to `most_n`. */
function ofTension(tension_n, scale) {
  if (!(tension_n > 0)) return SLACK;
  return ofRange((tension_n - scale.least_n) / (scale.most_n - scale.least_n));
}
