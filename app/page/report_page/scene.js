// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The trajectory and the landmarks in 3-D; from above and from the side where the browser has no WebGL.

function hasWebGl() {
  try {
    const canvas = document.createElement('canvas');
    return Boolean(canvas.getContext('webgl2') || canvas.getContext('webgl'));
  } catch {
    return false;
  }
}

/** Landmarks near enough to be looked at with the trajectory: one whose depth is hardly known may lie
    a kilometre off, and would shrink all else to a dot. */
function nearLandmarks(landmarks, p) {
  const way = p ? p[0].map((_, k) => p.map((axis) => axis[k])).filter((row) => row.every(known)) : [];
  const from = way.length ? way : landmarks;
  if (!from.length) return {near: [], limit: null};
  const center = [0, 1, 2].map((i) => quantile(from.map((row) => row[i]), 0.5));
  const distance = (row) => Math.hypot(...center.map((c, i) => row[i] - c));
  const reach = way.length ? largest(way.map(distance)) : 0;
  const limit = reach + 2 * (quantile(landmarks.map(distance), 0.5) ?? 0);
  return {near: landmarks.filter((row) => distance(row) <= limit), limit};
}

/** At some two dozen places the ellipsoid of 3 sigma (axes along x, y, z) as three rings. */
function sigmaRings(p, sigma, places = 24, corners = 20) {
  const rings = [[], [], []];
  const at = p[0].map((_, k) => k).filter((k) => p.every((a) => known(a[k])) && sigma.every((s) => known(s[k])));
  const step = Math.max(1, Math.floor(at.length / places));
  for (let n = step - 1; n < at.length; n += step) {
    const k = at[n];
    for (const [a, b] of [[0, 1], [1, 2], [2, 0]]) {
      for (let c = 0; c <= corners; ++c) {
        const angle = 2 * Math.PI * c / corners;
        for (let i = 0; i < 3; ++i) {
          const part = i === a ? Math.cos(angle) : i === b ? Math.sin(angle) : 0;
          rings[i].push(p[i][k] + 3 * sigma[i][k] * part);
        }
      }
      rings.forEach((column) => column.push(null));
    }
  }
  return rings;
}

function wayTraces(run, near) {
  const {t, p, sigma} = run.states;
  const traces = [];
  const add = (name, xyz, more) => traces.push({name, x: xyz[0], y: xyz[1], z: xyz[2], ...more});
  if (near.length) {
    const heights = near.map((row) => row[2]);
    const ages = near.every((row) => known(row[3])) ? near.map((row) => row[3]) : null;
    const bar = (title) => ({title: {text: title, side: 'right'}, thickness: 12, len: 0.6, outlinewidth: 0});
    add('landmarks', [0, 1, 2].map((i) => near.map((row) => row[i])), {
      mode: 'markers', hoverinfo: 'skip', ages, heights,
      marker: {size: 1.6, color: heights, colorscale: heightScale, cmin: quantile(heights, 0.02), cmax: quantile(heights, 0.98),
        opacity: 0.6, colorbar: bar('height of landmarks [m]')},
    });
  }
  if (p && sigma.p) {
    const rings = sigmaRings(p, sigma.p);
    if (rings[0].length) add('3 sigma', rings, {mode: 'lines', hoverinfo: 'skip', line: {color: colours.sky, width: 2}});
  }
  if (run.truth.p) {
    add('truth', run.truth.p, {mode: 'lines', line: {color: colours.black, width: 3}, text: run.truth.t, hovertemplate: hoverAt('truth')});
  }
  if (p) {
    add('estimate', p, {
      mode: 'lines', connectgaps: false, line: {color: colours.red, width: 6}, text: t, hovertemplate: hoverAt('estimate')});
    const given = p[0].map((_, k) => k).filter((k) => p.every((axis) => known(axis[k])));
    const end = (name, k, symbol) => add(name, p.map((axis) => [axis[k]]), {
      mode: 'markers', hovertemplate: `${name}<extra></extra>`,
      marker: {size: 5, symbol, color: colours.red, line: {color: '#ffffff', width: 1}}});
    if (given.length > 1) {
      end('start', given[0], 'circle');
      end('end', given.at(-1), 'square');
    }
  }
  return traces;
}
const hoverAt = (what) => `${what} at %{text:.2f} s<br>x %{x:.3f} m<br>y %{y:.3f} m<br>z %{z:.3f} m<extra></extra>`;

/** The same traces as a map (x, y) and a side view (x, z). */
function planTraces(traces) {
  return ['y', 'z'].flatMap((up, view) => traces.map((trace) => {
    const {x, z, y, ages, heights, ...rest} = trace;
    const flat = {...rest, type: 'scatter', x, y: up === 'y' ? y : z, showlegend: view === 0, legendgroup: trace.name,
      xaxis: view ? 'x2' : 'x', yaxis: view ? 'y2' : 'y'};
    if (flat.hovertemplate) flat.hoverinfo = 'skip', delete flat.hovertemplate;
    if (flat.line && flat.mode === 'lines') flat.line = {...flat.line, width: Math.min(2, flat.line.width)};
    if (flat.marker?.colorbar) flat.marker = {...flat.marker, size: 3, showscale: view === 0};
    return flat;
  }));
}

/** A picture of the view, for paper only: browsers print what WebGL draws as a white area. Taken anew
    after each turn; the first one once the page is there. */
function keepForPrint(div) {
  const picture = document.createElement('img');
  picture.className = 'print-only';
  picture.alt = 'Trajectory and landmarks';
  div.after(picture);
  const take = async () => {
    picture.src = await Plotly.toImage(div, {format: 'png', width: div.clientWidth, height: div.clientHeight, scale: 1.5});
    div.classList.add('screen-only');
  };
  let waiting = setTimeout(take, 2000);
  div.on('plotly_relayout', () => {
    clearTimeout(waiting);
    waiting = setTimeout(take, 500);
  });
}

async function drawWay(run) {
  const {near, limit} = nearLandmarks(run.landmarks, run.states.p);
  const traces = wayTraces(run, near);
  if (!traces.length) {
    sayMissing('plot-way', 'No trajectory, true positions or landmarks are given.');
    return;
  }
  const said = [];
  if (!run.states.p) said.push('There is no estimated trajectory.');
  if (!run.truth.p) said.push('No true trajectory is given.');
  if (!run.landmarks.length) said.push('No landmarks are given.');
  if (near.length < run.landmarks.length) {
    said.push(`${near.length} of ${run.landmarks.length} landmarks are shown; the others are more than ${show(limit)} m away.`);
  }
  if (traces.some((trace) => trace.name === '3 sigma')) {
    const wide = run.states.sigma.p.flat();
    said.push(`Rings: 3 sigma of the position here and there${run.sigmaMeaning ? `, ${run.sigmaMeaning}` : ''} ` +
      `(median ${show(3 * quantile(wide, 0.5))} m, largest ${show(3 * largest(wide))} m).`);
  }
  const legend = {orientation: 'h', x: 0, y: 1.02, yanchor: 'bottom', font: {...font, size: 12}, itemsizing: 'constant'};
  let div;
  if (hasWebGl()) {
    said.unshift('Drag to turn, scroll to come nearer; a click in the legend hides.');
    const side = (title) => ({title: {text: title}, backgroundcolor: '#ffffff', gridcolor: '#dfe3e8', zerolinecolor: '#b9c1cb',
      showspikes: false});
    const ages = traces[0].ages;
    const choice = (label, values, title) => ({label, method: 'restyle', args: [{
      'marker.color': [values], 'marker.cmin': quantile(values, 0.02), 'marker.cmax': quantile(values, 0.98),
      'marker.colorbar.title.text': title}, [0]]});
    div = await draw('plot-way', traces.map((trace) => ({...trace, type: 'scatter3d'})), {
      ...baseLayout(), hovermode: 'closest', legend, margin: {l: 0, r: 0, t: 8, b: 0},
      scene: {aspectmode: 'data', xaxis: side('x [m]'), yaxis: side('y [m]'), zaxis: side('z [m]'),
        camera: {eye: {x: -0.97, y: -1.13, z: 0.82}, center: {x: 0, y: 0, z: -0.08}, projection: {type: 'perspective'}}},
      updatemenus: ages ? [{type: 'buttons', direction: 'right', x: 1, xanchor: 'right', y: 0, yanchor: 'bottom', pad: {b: 6, r: 2},
        font: {...font, size: 12}, bgcolor: '#ffffff', bordercolor: '#c3cad3', buttons: [
          choice('by height', traces[0].heights, 'height of landmarks [m]'), choice('by times seen', ages, 'frames that saw it')]}] : [],
    });
    div.dataset.view = '3d';
    keepForPrint(div);
  } else {
    said.unshift('This browser has no WebGL, so there is no 3-D view: from above (left) and from the side (right).');
    div = await draw('plot-way', planTraces(traces), {
      ...baseLayout(), hovermode: 'closest', legend,
      xaxis: axis('x [m]', {domain: [0, 0.47]}), yaxis: axis('y [m]', {scaleanchor: 'x'}),
      xaxis2: axis('x [m]', {domain: [0.55, 1], anchor: 'y2'}), yaxis2: axis('z [m]', {scaleanchor: 'x2', anchor: 'x2'}),
    });
    div.dataset.view = 'plan';
  }
  caption('way', ...said);
}
