// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Time per stage, features, events: over time, and as tables.

/** Fills a table: heads, then rows of texts; a row's first text may be an element. */
function fillTable(table, heads, rows) {
  const row = (cells, kind) => {
    const tr = document.createElement('tr');
    for (const cell of cells) {
      const place = document.createElement(kind);
      place.append(cell);
      tr.append(place);
    }
    return tr;
  };
  table.replaceChildren(...(heads ? [row(heads, 'th')] : []), ...rows.map((cells) => row(cells, 'td')));
}

function named(colour, name) {
  const place = document.createElement('span');
  const swatch = document.createElement('span');
  swatch.className = 'swatch';
  swatch.style.background = colour;
  place.append(swatch, name);
  return place;
}

/** Neighbouring frames as one, so that there are at most `most` bars: [first, past the last]. */
function binsOf(count, most) {
  const size = Math.max(1, Math.ceil(count / most));
  return Array.from({length: Math.ceil(count / size)}, (_, k) => [k * size, Math.min(count, (k + 1) * size)]);
}
function meanOf(values) {
  const given = values.filter(known);
  return given.length ? given.reduce((a, b) => a + b, 0) / given.length : null;
}

async function drawStages(run, range) {
  const {t, names, ms, sum, total} = run.stages;
  if (!range || !total.some(known)) {
    sayMissing('plot-stages', 'No times are given.');
    sayMissing('table-stages', 'No times are given.');
    return;
  }
  const rest = total.map((whole, k) => (known(whole) && known(sum[k]) ? Math.max(0, whole - sum[k]) : null));
  const columns = names.map((name, i) => ({name, ms: ms[i], colour: stageColours[i % stageColours.length]}));
  if (!names.length) columns.push({name: 'frame', ms: total, colour: colours.blue});
  else if (quantile(rest, 0.5) > 0.005 * quantile(total, 0.5)) columns.push({name: 'other', ms: rest, colour: colours.grey});
  const bins = binsOf(t.length, 240);
  const size = bins[0][1] - bins[0][0];
  const middle = bins.map(([a, b]) => meanOf(t.slice(a, b)));
  const steps = middle.slice(1).map((x, k) => x - middle[k]).filter((step) => step > 0);
  const width = steps.length ? quantile(steps, 0.5) : (range[1] - range[0]) / 50;
  const traces = columns.map((column) => ({
    type: 'bar', name: column.name, x: middle, y: bins.map(([a, b]) => meanOf(column.ms.slice(a, b))), width,
    showlegend: false, marker: {color: column.colour, line: {width: 0}}, hovertemplate: '%{y:.2f} ms',
  }));
  const slowest = bins.map(([a, b]) => largest(total.slice(a, b)));
  if (size > 1) {
    traces.push({type: 'scatter', mode: 'markers', name: 'slowest', x: middle, y: slowest,
      marker: {color: colours.black, size: 4, symbol: 'line-ew-open', line: {width: 1.2}}, hovertemplate: '%{y:.2f} ms'});
  }
  // One slow frame must not make all others flat.
  const most = largest(total);
  let top = Math.min(1.1 * most, 4 * quantile(total, 0.95) || Infinity) || 1;
  const above = total.filter((x) => x > top).length;
  const hasLine = run.period !== null && run.period <= 5 * top;
  if (hasLine) {
    top = Math.max(top, 1.12 * run.period);
    traces.push({type: 'scatter', mode: 'lines', name: `camera's period, ${show(run.period)} ms`, x: range, y: [run.period, run.period],
      line: {color: colours.black, width: 1.5, dash: 'dash'}, hoverinfo: 'skip'});
  }
  await drawOverTime('plot-stages', traces, {...baseLayout(), barmode: 'stack', bargap: 0, shapes: milestones(run),
    xaxis: timeAxis(range), yaxis: axis('time [ms]', {range: [0, top]})});
  const late = run.period === null ? 0 : total.filter((x) => x > run.period).length;
  caption('stages', size > 1 && `Each bar is the mean of ${size} frames; dashes are the slowest of them.`,
          above > 0 && `${above} of ${total.filter(known).length} frames went above ${show(top)} ms (slowest: ${show(most)} ms).`,
          run.period === null ? 'The camera\'s period is not given.' :
            `${late ? late : 'No'} frame${late === 1 ? '' : 's'} took longer than the camera's period of ${show(run.period)} ms` +
            `${hasLine ? '' : ', which lies far above this picture'}.`);
  const figures = (values) => [0.5, 0.99, 1].map((q) => (values.some(known) ? quantile(values, q).toFixed(2) : '–'));
  const table = document.getElementById('table-stages');
  fillTable(table, ['ms', 'median', 'p99', 'max'],
            [...columns.map((c) => [named(c.colour, c.name), ...figures(c.ms)]), ['whole frame', ...figures(total)]]);
  table.lastElementChild.className = 'whole';
}

async function drawFeatures(run, range) {
  const {t, count, age, landmarks} = run.features;
  if (!range || !(count || age || landmarks)) {
    sayMissing('plot-features', 'No features are given.');
    return;
  }
  const traces = [];
  if (count) traces.push(line('features in the image', t, count, colours.blue, {hovertemplate: '%{y:d}'}));
  if (landmarks) traces.push(line('landmarks in the window', t, landmarks, colours.orange, {hovertemplate: '%{y:d}'}));
  if (age) traces.push(line('median age of the tracks', t, age, colours.green, {yaxis: 'y2', hovertemplate: '%{y:.4~g} frames'}));
  const upper = count || landmarks;
  await drawOverTime('plot-features', traces, {...baseLayout(), shapes: milestones(run),
    xaxis: timeAxis(range, {anchor: age ? 'y2' : 'y'}),
    yaxis: axis('number', {domain: age ? [upper ? 0.42 : 1, 1] : [0, 1], rangemode: 'tozero', visible: Boolean(upper)}),
    ...(age && {yaxis2: axis('age [frames]', {domain: [0, upper ? 0.36 : 1], rangemode: 'tozero'})})});
  caption('features', count && `Fewest features: ${show(smallest(count))}.`, !age && 'Ages are not given.');
}

// What happens all the time in a run that is well.
const ordinaryEvents = new Set(['initialized', 'keyframe', 'observation rejected', 'landmark triangulated', 'landmark marginalized',
  'landmark starved', 'imu term replaced', 'standing still']);
const eventColour = (what) => (what === 'initialized' ? colours.green : ordinaryEvents.has(what) ? colours.blue : colours.red);

/** Of each kind at most `most` marks: what comes closer is summed up. */
function marksOf(events, range, most = 400) {
  if (events.length <= most) return events;
  const sums = new Map();
  for (const e of events) {
    const bin = Math.floor(most * (e.t - range[0]) / (range[1] - range[0]));
    const mark = sums.get(bin) ?? {t: e.t, what: e.what, count: 0};
    mark.count += e.count;
    sums.set(bin, mark);
  }
  return [...sums.values()];
}

async function drawEvents(run, range) {
  const counted = run.eventCounts.filter(([, n]) => n > 0);
  if (counted.length) {
    counted.sort(([a, m], [b, n]) => ordinaryEvents.has(a) - ordinaryEvents.has(b) || n - m);
    fillTable(document.getElementById('table-events'), ['event', 'count'],
              counted.map(([what, n]) => [named(eventColour(what), what), String(n)]));
  } else {
    sayMissing('table-events', run.eventCounts.length ? 'Nothing has happened.' : 'No counts are given.');
  }
  if (!run.events.length) {
    sayMissing('plot-events', 'No events are given.');
    return;
  }
  const kinds = [...new Set(run.events.map((e) => e.what))]
      .sort((a, b) => ordinaryEvents.has(a) - ordinaryEvents.has(b) || a.localeCompare(b)).reverse();
  const traces = kinds.map((what) => {
    const marks = marksOf(run.events.filter((e) => e.what === what), range);
    return {type: 'scatter', mode: 'markers', name: what, x: marks.map((m) => m.t), y: marks.map(() => what),
      text: marks.map((m) => String(m.count)), hovertemplate: `%{x:.2f} s: ${what.replaceAll(/[<>%{}]/g, '')}, %{text}<extra></extra>`,
      marker: {color: eventColour(what), opacity: 0.75, symbol: ordinaryEvents.has(what) ? 'circle' : 'diamond',
        line: {width: 0}, size: marks.map((m) => (ordinaryEvents.has(what) ? 4 : 8) + Math.min(6, Math.log2(Math.max(1, m.count))))}};
  });
  document.getElementById('plot-events').style.height = `${Math.max(160, 62 + 26 * kinds.length)}px`;
  await drawOverTime('plot-events', traces, {...baseLayout(), hovermode: 'closest', showlegend: false, xaxis: timeAxis(range),
    yaxis: {...axisStyle, type: 'category', categoryorder: 'array', categoryarray: kinds, range: [-0.6, kinds.length - 0.4]}});
  caption('events', 'The larger the mark, the more at once.',
          kinds.some((what) => !ordinaryEvents.has(what)) ? 'Diamonds: what a run without trouble does not have.' : '');
}
