// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// From the data as they come, of which anything may be absent, to columns to be drawn.
'use strict';

const known = Number.isFinite;  // null and undefined are not
const list = (x) => (Array.isArray(x) ? x : []);
const record = (x) => (x !== null && typeof x === 'object' && !Array.isArray(x) ? x : {});
const numberOrNull = (x) => (known(x) ? x : null);

/** `count` numbers, null where there is none. */
function numbers(column, count) {
  const values = list(column);
  return Array.from({length: count}, (_, k) => numberOrNull(values[k]));
}

/** Rows of `width` numbers as `width` columns of `count`; null if no row has a number. */
function columns(rows, width, count) {
  const all = Array.from({length: width}, (_, i) => numbers(list(rows).map((row) => list(row)[i]), count));
  return all.some((column) => column.some(known)) ? all : null;
}

function readStates(states) {
  const t = list(states.t).map(numberOrNull);
  const triple = (key) => columns(states[key], 3, t.length);
  return {
    t, p: triple('p'), q: columns(states.q, 4, t.length), v: triple('v'), ba: triple('ba'), bg: triple('bg'),
    error: triple('error_p'), sigma: {p: triple('sigma_p'), v: triple('sigma_v'), ba: triple('sigma_ba'), bg: triple('sigma_bg')},
  };
}

function readStages(stages) {
  const t = list(stages.t).map(numberOrNull);
  const names = list(stages.names).map(String);
  const ms = names.map((_, i) => numbers(list(stages.ms)[i], t.length));
  const sum = t.map((_, k) => {
    const given = ms.map((column) => column[k]).filter(known);
    return given.length ? given.reduce((a, b) => a + b, 0) : null;
  });
  const total = list(stages.total).some(known) ? numbers(stages.total, t.length) : sum;
  return {t, names, ms, sum, total};
}

function readFeatures(features) {
  const t = list(features.t).map(numberOrNull);
  const column = (key) => (list(features[key]).some(known) ? numbers(features[key], t.length) : null);
  return {t, count: column('count'), age: column('age'), landmarks: column('landmarks')};
}

/** What the page draws; nothing in it is absent, but lists may be empty and columns null. */
function readRun(raw) {
  const data = record(raw);
  const truth = record(data.truth);
  const truthTimes = list(truth.t).map(numberOrNull);
  return {
    title: typeof data.title === 'string' && data.title ? data.title : 'Report of a run',
    origin: typeof data.origin === 'string' ? data.origin : '',
    appVersion: typeof data.app_version === 'string' ? data.app_version.split('\n')[0] : '',
    figures: record(data.figures),
    trajectoryOnly: data.trajectory_only === true,
    sigmaMeaning: typeof data.sigma_meaning === 'string' ? data.sigma_meaning : '',
    period: known(data.camera_period_ms) && data.camera_period_ms > 0 ? data.camera_period_ms : null,
    states: readStates(record(data.states)),
    truth: {t: truthTimes, p: columns(truth.p, 3, truthTimes.length)},
    landmarks: list(data.landmarks).filter((row) => list(row).slice(0, 3).filter(known).length === 3),
    stages: readStages(record(data.stages)),
    features: readFeatures(record(data.features)),
    events: list(data.events).map(record).filter((e) => known(e.t)).map(
        (e) => ({t: e.t, what: spaced(e.what), count: known(e.count) ? e.count : 1})),
    eventCounts: countsOf(record(record(data.figures).events), record(data.event_counts)),
    thumbnails: list(data.thumbnails).map(record).filter((image) => typeof image.jpeg === 'string'),
  };
}

/** Pairs of event and number; what is given in both is taken from the second. */
function countsOf(...given) {
  const all = new Map();
  for (const counts of given) {
    for (const [what, n] of Object.entries(counts)) if (known(n)) all.set(spaced(what), n);
  }
  return [...all];
}

/** "observation_rejected" and "observation rejected" are one. */
const spaced = (what) => String(what ?? 'unnamed').replaceAll('_', ' ');

/** Between the sorted values, linearly; as glissade's eval::Quantile. */
function quantile(values, q) {
  const sorted = values.filter(known).sort((a, b) => a - b);
  if (!sorted.length) return null;
  const at = q * (sorted.length - 1);
  const below = Math.floor(at);
  const above = Math.min(below + 1, sorted.length - 1);
  return sorted[below] + (at - below) * (sorted[above] - sorted[below]);
}

/** The extreme ones of those that are known, else null. */
const largest = (values) => values.reduce((a, b) => (known(b) && (a === null || b > a) ? b : a), null);
const smallest = (values) => values.reduce((a, b) => (known(b) && (a === null || b < a) ? b : a), null);

/** First and last time of everything on the page, null if nothing has one. */
function timeRange(run) {
  const all = [run.states.t, run.stages.t, run.features.t, run.events.map((e) => e.t)];
  const first = smallest(all.map(smallest)), last = largest(all.map(largest));
  if (first === null) return null;
  return last > first ? [first, last] : [first - 0.5, first + 0.5];
}

/** The true position at the time t, linearly between its neighbours; null outside, and where these
    are further apart than `gap` seconds. */
function truthAt(truth, t, gap = 0.5) {
  if (!known(t)) return null;
  let low = 0, high = truth.t.length - 1;
  if (high < 0 || !(truth.t[0] <= t) || !(t <= truth.t[high])) return null;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (truth.t[middle] <= t) low = middle; else high = middle;
  }
  const span = truth.t[high] - truth.t[low];
  if (span > gap) return null;
  const part = span > 0 ? (t - truth.t[low]) / span : 0;
  const at = truth.p.map((axis) =>
    (known(axis[low]) && known(axis[high]) ? axis[low] + part * (axis[high] - axis[low]) : null));
  return at.every(known) ? at : null;
}

/** Estimate minus truth, a column an axis; null where there is no truth at any of the times. */
function positionErrors(run) {
  const {t, p} = run.states;
  if (!p || !run.truth.p) return null;
  const truth = t.map((time) => truthAt(run.truth, time));
  const errors = p.map((axis, i) => axis.map((x, k) => (known(x) && truth[k] ? x - truth[k][i] : null)));
  return errors[0].some(known) ? errors : null;
}

/** Length of the way through the points, m. */
function pathLength(p) {
  let length = 0, last = null;
  for (let k = 0; k < p[0].length; ++k) {
    const point = p.map((axis) => axis[k]);
    if (!point.every(known)) continue;
    if (last) length += Math.hypot(...point.map((x, i) => x - last[i]));
    last = point;
  }
  return length;
}

/** |v| and its sigma, to first order, from those of the axes. */
function speedOf(v, sigma) {
  const speed = v[0].map((_, k) => {
    const at = v.map((axis) => axis[k]);
    return at.every(known) ? Math.hypot(...at) : null;
  });
  const spread = sigma && speed.map((s, k) => {
    const at = sigma.map((axis) => axis[k]);
    if (!known(s) || !at.every(known)) return null;
    return s > 1e-9 ? Math.hypot(...at.map((x, i) => x * v[i][k] / s)) : Math.max(...at);
  });
  return {speed, sigma: spread};
}

/** Velocity between neighbours, where none is given. */
function velocityOf(t, p) {
  return p.map((axis) => axis.map((x, k) => {
    const v = k > 0 ? (x - axis[k - 1]) / (t[k] - t[k - 1]) : NaN;
    return k > 0 && known(x) && known(axis[k - 1]) ? numberOrNull(v) : null;
  }));
}

/** Hamilton product of quaternions x y z w. */
function times(a, b) {
  return [a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]];
}

/** Roll, pitch and yaw (degrees, continuous) of the rotation since the first state, in the axes of the
    world: whichever way the IMU is mounted, they are small angles and a heading. */
function anglesSinceStart(q) {
  const rows = q[0].map((_, k) => q.map((part) => part[k]));
  const first = rows.find((row) => row.every(known));
  const inverse = first && [-first[0], -first[1], -first[2], first[3]];
  const angles = [[], [], []], last = [0, 0, 0];
  for (const row of rows) {
    const known4 = row.every(known);
    const [x, y, z, w] = known4 ? times(row, inverse) : [];
    const now = known4 && [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
      Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x)))),
      Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))].map((a) => a * 180 / Math.PI);
    for (let i = 0; i < 3; ++i) {
      if (now) last[i] = now[i] + 360 * Math.round((last[i] - now[i]) / 360);
      angles[i].push(now ? last[i] : null);
    }
  }
  return angles;
}
