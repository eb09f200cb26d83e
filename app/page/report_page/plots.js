// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What all plots share: colours, axes, bands, and the one range of time of all plots over time.

// Okabe and Ito's colours: told apart by colour-blind eyes, too.
const colours = {
  blue: '#0072b2', red: '#d55e00', green: '#009e73', orange: '#e69f00', sky: '#56b4e9', pink: '#cc79a7',
  black: '#22262c', grey: '#8a93a0',
};
const axisNames = ['x', 'y', 'z'];
const axisColours = [colours.red, colours.green, colours.blue];
const stageColours = [colours.blue, colours.orange, colours.green, colours.pink, colours.sky, colours.red, '#b8a800', colours.black];
// Dark blue to ochre, ever lighter but never too light for white paper.
const heightScale = [[0, '#0b2559'], [0.25, '#1c5a70'], [0.5, '#4c7d4f'], [0.75, '#a08c2d'], [1, '#e39a3f']];
// Yellow to violet: seen on grey images.
const ageScale = ['#ffe34d', '#ffab3d', '#f2665e', '#d14fb0', '#a06cf5'];

const transparent = (hex, alpha) =>
  `rgba(${[1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16)).join(',')},${alpha})`;

/** A number for people: about three figures, no exponent where it can be helped. */
function show(x) {
  const size = Math.abs(x);
  if (size === 0) return '0';
  if (size < 0.001 || size >= 1e7) return x.toExponential(1);
  return x.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.1 ? 3 : 4);
}
const percent = (part, whole) => (whole > 0 ? `${(100 * part / whole).toFixed(part === whole ? 0 : 1)} %` : 'unknown');

const font = {family: 'system-ui, "Segoe UI", Roboto, "DejaVu Sans", Arial, sans-serif', size: 12, color: '#1c2430'};
const axisStyle = {
  gridcolor: '#e9ecf0', linecolor: '#aab2bd', zerolinecolor: '#c3cad3', ticks: 'outside', tickcolor: '#aab2bd',
  ticklen: 4, automargin: true,
};
const axis = (title, more = {}) => ({...axisStyle, title: {text: title, standoff: 8}, ...more});
const baseLayout = () => ({
  font, paper_bgcolor: '#ffffff', plot_bgcolor: '#ffffff', margin: {l: 58, r: 14, t: 8, b: 42},
  hovermode: 'x unified', hoverlabel: {font: {...font, size: 12}}, showlegend: true,
  legend: {orientation: 'h', x: 0, y: 1.02, yanchor: 'bottom', font: {...font, size: 12}},
});
const plotConfig = {
  responsive: true, displaylogo: false, showSendToCloud: false,
  modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d'],
};

/** "12 points" of each trace as it has been drawn, for whoever asks the page what it shows. */
function noteTraces(div) {
  const counts = {};
  for (const trace of div.data) {
    const columns = [trace.x, trace.y, trace.z].filter((c) => c !== undefined);
    const count = Array.from(columns[0]).filter((_, k) => columns.every((c) => c[k] !== null && c[k] !== undefined)).length;
    counts[trace.name] = (counts[trace.name] ?? 0) + count;
  }
  div.dataset.traces = JSON.stringify(counts);
}

/** Draws; a promise of the element. */
async function draw(id, traces, layout) {
  const div = document.getElementById(id);
  await Plotly.newPlot(div, traces, layout, plotConfig);
  noteTraces(div);
  return div;
}

/** Says in the place of a plot or a table why there is none. */
function sayMissing(id, text) {
  const place = document.getElementById(id);
  const line = document.createElement('p');
  line.className = 'missing';
  line.textContent = text;
  place.classList.add('empty');
  place.replaceChildren(line);
}
const caption = (id, ...sentences) => {
  document.getElementById(`caption-${id}`).textContent = sentences.filter(Boolean).join(' ');
};

/** y as a line over t; gaps stay gaps. */
const line = (name, t, y, colour, more = {}) => ({
  type: 'scatter', mode: 'lines', name, x: t, y, connectgaps: false, line: {color: colour, width: 1.5},
  hovertemplate: '%{y:.4~g}', ...more,
});

/** center +- half as an area: one closed outline for each piece without gaps. */
function band(name, t, center, half, colour, more = {}) {
  const x = [], y = [];
  let piece = [];
  const close = () => {
    if (piece.length > 1) {
      if (x.length) { x.push(null); y.push(null); }
      for (const k of piece) { x.push(t[k]); y.push(center[k] + half[k]); }
      for (const k of piece.reverse()) { x.push(t[k]); y.push(center[k] - half[k]); }
    }
    piece = [];
  };
  for (let k = 0; k < t.length; ++k) {
    if (known(t[k]) && known(center[k]) && known(half[k])) piece.push(k); else close();
  }
  close();
  return {
    type: 'scatter', mode: 'lines', name, x, y, fill: 'toself', fillcolor: transparent(colour, 0.17),
    line: {width: 0, color: transparent(colour, 0.35)}, hoverinfo: 'skip', ...more,
  };
}
const thrice = (sigma) => sigma.map((s) => (known(s) ? 3 * s : null));

/** Shows all of the values, and of their band what is not far beyond them for a moment only (the
    first sigmas of a run may be a hundred times the later ones). */
function rangeAround(values, halves, center = values) {
  const edges = [...values];
  const limit = quantile(halves, 0.95);
  halves.forEach((half, k) => {
    if (known(half) && half <= limit && known(center[k])) edges.push(center[k] + half, center[k] - half);
  });
  const low = smallest(edges), high = largest(edges);
  if (low === null) return undefined;
  const margin = 0.06 * (high - low) || 1e-6;
  return [low - margin, high + margin];
}

// ---- Time ------------------------------------------------------------------------------------------

const timePlots = [];

const timeAxis = (range, more = {}) => axis('time [s]', {range: [...range], hoverformat: '.3f', ...more});

/** Draws over time; a zoom into one such plot is a zoom into all. */
async function drawOverTime(id, traces, layout) {
  const div = await draw(id, traces, layout);
  timePlots.push(div);
  div.on('plotly_relayout', (change) => {
    const key = Object.keys(change).find((name) => /^xaxis\d*\.range(\[0\])?$/.test(name));
    if (!key || div.isFollowing) return;
    const range = div.layout[key.split('.')[0]].range;
    for (const other of timePlots) {
      if (other === div) continue;
      other.isFollowing = true;
      Plotly.relayout(other, {'xaxis.range': [...range]}).finally(() => { other.isFollowing = false; });
    }
  });
}

/** Lines across a plot where the run initialised and where it began anew. */
function milestones(run) {
  const shapes = [];
  const add = (t, colour, dash) => shapes.push({
    type: 'line', xref: 'x', yref: 'paper', x0: t, x1: t, y0: 0, y1: 1, opacity: 0.8, line: {color: colour, width: 1, dash},
  });
  const of = (what) => run.events.filter((e) => e.what === what).slice(0, 50);
  for (const e of of('initialized')) add(e.t, colours.green, 'dash');
  for (const e of of('reset')) add(e.t, colours.red, 'dot');
  return shapes;
}
function milestonesSaid(run) {
  const has = (what) => run.events.some((e) => e.what === what);
  const said = [has('initialized') && 'dashed green: initialized', has('reset') && 'dotted red: reset'].filter(Boolean);
  return said.length ? `Vertical lines: ${said.join('; ')}.` : '';
}
