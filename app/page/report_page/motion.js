// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Position, speed, attitude and biases over time.

/** Three plots, one above another, on one axis of time. */
function threeRows(range, titles, ranges, shapes) {
  const layout = {...baseLayout(), shapes};
  const height = 1 / 3, gap = 0.035;
  titles.forEach((title, i) => {
    const top = 1 - i * height;
    layout[i ? `yaxis${i + 1}` : 'yaxis'] = axis(title, {domain: [top - height + (i < 2 ? gap : 0), top], range: ranges[i]});
  });
  layout.xaxis = timeAxis(range, {anchor: 'y3'});
  return layout;
}

async function drawPosition(run, range) {
  const {t, p, sigma} = run.states;
  if (!p || !range) {
    sayMissing('plot-position', 'There is no estimated position.');
    return;
  }
  // Without sigmas a given error is that of the estimate.
  const errors = sigma.p ? positionErrors(run) : run.states.error ?? positionErrors(run);
  if (errors) document.getElementById('heading-position').textContent = 'Error of the position';
  const shown = errors ?? p;
  const traces = [], ranges = [];
  const inside = [];
  // The sigmas may be of another error than that.
  const judgedError = run.states.error ?? (run.sigmaMeaning ? null : errors);
  shown.forEach((values, i) => {
    const place = {yaxis: i ? `y${i + 1}` : 'y', showlegend: i === 0};
    const center = errors ? t.map(() => 0) : values;
    const half = sigma.p ? thrice(sigma.p[i]) : [];
    if (sigma.p) traces.push(band('3 sigma', t, center, half, colours.blue, {...place, legendgroup: 'band'}));
    traces.push(line(errors ? 'estimate minus truth' : 'estimate', t, values, colours.red,
                     {...place, legendgroup: 'line', hovertemplate: `${axisNames[i]} %{y:.4~g} m<extra></extra>`}));
    const ofSigma = errors && sigma.p && run.states.error ? run.states.error[i] : [];
    if (ofSigma.length) {
      traces.push(line('error that the band is for', t, ofSigma, colours.blue, {
        ...place, legendgroup: 'ofSigma', line: {color: colours.blue, width: 1},
        hovertemplate: `${axisNames[i]} %{y:.4~g} m<extra></extra>`}));
    }
    ranges.push(rangeAround([...values, ...ofSigma], half, center));
    const error = judgedError ? judgedError[i] : [];
    const judged = error.map((x, k) => k).filter((k) => known(error[k]) && known(half[k]));
    inside.push([judged.filter((k) => Math.abs(error[k]) <= half[k]).length, judged.length]);
  });
  const titles = axisNames.map((name) => (errors ? `error in ${name} [m]` : `${name} [m]`));
  await drawOverTime('plot-position', traces, threeRows(range, titles, ranges, milestones(run)));
  const shares = inside.map(([part, whole], i) => `${axisNames[i]} ${percent(part, whole)}`).join(', ');
  caption('position',
          errors && inside[0][1] > 0 && `Inside the band: ${shares} of the frames with truth.`,
          run.truth.p && !errors && 'The truth is given for other times than the estimate.',
          !run.truth.p && 'No truth is given: the position itself is shown.',
          sigma.p ? run.sigmaMeaning && `The band is 3 sigma ${run.sigmaMeaning}.` : 'No sigmas are given.', milestonesSaid(run));
}

async function drawSpeed(run, range) {
  const {t, p, v, sigma} = run.states;
  if (!range || (!v && !p)) {
    sayMissing('plot-speed', 'There is neither velocity nor position.');
    return;
  }
  const {speed, sigma: spread} = speedOf(v ?? velocityOf(t, p), v && sigma.v);
  const traces = [];
  if (spread) traces.push(band('3 sigma', t, speed, thrice(spread), colours.blue));
  traces.push(line('estimate', t, speed, colours.red, {hovertemplate: '%{y:.3f} m/s<extra></extra>'}));
  const top = rangeAround(speed, spread ? thrice(spread) : [])?.[1];
  await drawOverTime('plot-speed', traces, {...baseLayout(), shapes: milestones(run), showlegend: true,
    xaxis: timeAxis(range), yaxis: axis('speed [m/s]', {range: top > 0 ? [0, top] : undefined})});
  caption('speed', !v && 'No velocity is estimated: this is the distance between neighbouring positions by the time.');
}

async function drawAttitude(run, range) {
  const {t, q} = run.states;
  if (!range || !q) {
    sayMissing('plot-attitude', 'There is no estimated attitude.');
    return;
  }
  const angles = anglesSinceStart(q);
  const traces = ['roll', 'pitch', 'yaw'].map((name, i) => line(name, t, angles[i], axisColours[i], {hovertemplate: '%{y:.1f}°'}));
  await drawOverTime('plot-attitude', traces,
                     {...baseLayout(), shapes: milestones(run), xaxis: timeAxis(range), yaxis: axis('rotation [°]')});
  caption('attitude', 'Turned since the first estimate, about the axes of the world.');
}

async function drawBias(run, range, id, bias, sigma, unit) {
  if (!range || !bias) {
    sayMissing(`plot-${id}`, 'No bias is estimated: the run is without an IMU, or never initialized.');
    return;
  }
  const {t} = run.states;
  const traces = [], ranges = [];
  bias.forEach((values, i) => {
    const half = sigma ? thrice(sigma[i]) : [];
    const place = {yaxis: i ? `y${i + 1}` : 'y', showlegend: i === 0};
    if (sigma) traces.push(band('3 sigma', t, values, half, colours.blue, {...place, legendgroup: 'band'}));
    traces.push(line('estimate', t, values, colours.red,
                     {...place, legendgroup: 'line', hovertemplate: `${axisNames[i]} %{y:.4~g} ${unit}<extra></extra>`}));
    ranges.push(rangeAround(values, half));
  });
  await drawOverTime(`plot-${id}`, traces, threeRows(range, axisNames.map((name) => `${name} [${unit}]`), ranges, milestones(run)));
  caption(id, !sigma && 'No sigmas are given.');
}
const drawGyroBias = (run, range) => drawBias(run, range, 'gyro-bias', run.states.bg, run.states.sigma.bg, 'rad/s');
const drawAccelBias = (run, range) => drawBias(run, range, 'accel-bias', run.states.ba, run.states.sigma.ba, 'm/s²');
