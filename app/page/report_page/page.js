// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Headings, figures, images; and the order of it all.

// Whatever goes wrong is to be seen, on the page and by a test that asks it: data-errors of <html>.
function tellError(what) {
  const root = document.documentElement;
  root.dataset.errors = String(Number(root.dataset.errors) + 1);
  const place = document.getElementById('errors');
  place.hidden = false;
  place.textContent += `${place.textContent ? '\n' : ''}This page could not be drawn as a whole: ${what}`;
}
window.addEventListener('error', (event) => tellError(event.message));
window.addEventListener('unhandledrejection', (event) => tellError(String(event.reason)));
const consoleError = console.error.bind(console);
console.error = (...words) => {
  tellError(words.map(String).join(' '));
  consoleError(...words);
};

function figuresOf(run, range) {
  const f = run.figures;
  const {t, p} = run.states;
  const value = (x, unit, more = {}) => ({value: known(x) ? show(x) : null, unit, ...more});
  const path = f.path_m > 0 ? f.path_m : p ? pathLength(p) : null;
  const duration = known(f.duration_s) ? f.duration_s : range && range[1] - range[0];
  // All stages, where they are known: the figures may be of the window alone.
  const ms = (given, q) => quantile(run.stages.total, q) ?? given;
  const frames = known(f.frames) ? f.frames : run.stages.t.length || null;
  const refused = [[f.frames_dropped, 'dropped'], [f.frames_refused, 'refused']].filter(([n]) => n > 0)
      .map(([n, what]) => `${n} ${what}`).join(', ');
  // The first state is there although nobody says when it came: from the states.
  const after = known(f.initialized_at_s) ? f.initialized_at_s : f.initialized_at_s === undefined ? smallest(t) : null;
  return [
    ['ATE', value(f.ate_m, 'm', {note: f.alignment ? `RMS, ${f.alignment} aligned` : 'RMS'})],
    ['RPE', value(f.rpe_percent, '%', {note: f.rpe_length_m > 0 ? `of the way, over ${show(f.rpe_length_m)} m` : 'of the way'})],
    ['RPE over 1 s', value(f.rpe_1s_m, 'm', {note: 'RMS'})],
    ['Scale error', value(f.scale_error_percent, '%')],
    ['Yaw error', value(f.ate_yaw_deg, '°', {note: 'RMS'})],
    ['Initialized after', after === null && !t.some(known) ? {value: 'never', unit: '', bad: true} : value(after, 's')],
    ['Time per frame', {...value(ms(f.median_ms, 0.5), 'ms'), note: noteOf('p99', ms(f.p99_ms, 0.99), 'ms')}],
    ['Frames', {value: frames === null ? null : String(frames), unit: '', note: refused}],
    ['Duration', value(duration, 's')],
    ['Path length', value(path, 'm', {note: f.path_m > 0 || !p ? '' : 'of the estimate'})],
  ];
}
const noteOf = (name, x, unit) => (known(x) ? `${name} ${show(x)} ${unit}` : `${name} unknown`);

function element(kind, className, text) {
  const made = document.createElement(kind);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

function drawFigures(run, range) {
  const place = document.getElementById('figures');
  for (const [name, figure] of figuresOf(run, range)) {
    if (run.trajectoryOnly && figure.value === null) continue;
    const tile = element('div');
    const dd = element('dd');
    if (figure.value === null) {
      dd.append(element('span', 'value unknown', 'unknown'));
    } else {
      dd.append(element('span', figure.bad ? 'value bad' : 'value', figure.value));
      if (figure.unit) dd.append(element('span', 'unit', ` ${figure.unit}`));
    }
    tile.append(element('dt', '', name), dd);
    if (figure.note && figure.value !== null) tile.append(element('dd', 'note', figure.note));
    place.append(tile);
  }
  const rows = [];
  const collect = (prefix, values) => {
    for (const [key, x] of Object.entries(values)) {
      if (Array.isArray(x)) continue;
      if (x !== null && typeof x === 'object') collect(`${prefix}${key}.`, x);
      else rows.push([prefix + key, x === null ? 'unknown' : String(x)]);
    }
  };
  collect('', run.figures);
  if (rows.length) fillTable(document.querySelector('#more-figures table'), null, rows);
  else document.getElementById('more-figures').hidden = true;
}

function drawNotice(run) {
  const said = [];
  if (run.figures.interrupted === true) said.push('The run was interrupted: this is what there was until then.');
  if (!run.states.t.some(known)) {
    const why = run.figures.first_refusal;
    said.push('This run never initialized: there is no estimate.' + (why ? ` The first refusal: ${why}` : ''));
  }
  const place = document.getElementById('notice');
  place.textContent = said.join('\n');
  place.hidden = !said.length;
}

/** A colour for the age of a track, from young to old. */
function ageColour(age, oldest) {
  const at = oldest > 0 ? Math.max(0, Math.min(1, age / oldest)) : 0;
  return ageScale[Math.round(at * (ageScale.length - 1))];
}

function thumbnail(image, oldest) {
  const width = image.width > 0 ? image.width : 4, height = image.height > 0 ? image.height : 3;
  const scale = image.scale > 0 ? image.scale : 1;
  const figure = element('figure');
  figure.tabIndex = 0;
  const picture = element('div', 'picture');
  picture.style.aspectRatio = `${width} / ${height}`;
  const photo = element('img');
  const when = known(image.t) ? `${image.t.toFixed(2)} s` : 'time unknown';
  photo.alt = `Image at ${when}`;
  photo.addEventListener('error', () => picture.replaceChildren(element('p', 'missing', 'This image cannot be shown.')));
  photo.src = `data:image/jpeg;base64,${image.jpeg}`;
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg');
  svg.setAttribute('viewBox', `0 0 ${width / scale} ${height / scale}`);
  svg.setAttribute('preserveAspectRatio', 'none');
  const tracks = list(image.tracks).filter((track) => Array.isArray(list(track)[1]));
  for (const [age, places] of tracks) {
    const points = places.filter(known);
    if (points.length < 2 || points.length !== places.length || points.length % 2) continue;
    if (points.length === 2) points.push(...points);  // a dot
    const tail = document.createElementNS(space, 'polyline');
    tail.setAttribute('points', points.join(' '));
    tail.setAttribute('stroke', ageColour(age, oldest));
    svg.append(tail);
    const head = document.createElementNS(space, 'circle');
    head.setAttribute('cx', points.at(-2));
    head.setAttribute('cy', points.at(-1));
    head.setAttribute('r', String(1.1 / scale));
    head.setAttribute('fill', ageColour(age, oldest));
    svg.append(head);
  }
  picture.append(photo, svg);
  figure.append(picture, element('figcaption', '', `${when}, ${tracks.length} track${tracks.length === 1 ? '' : 's'}`));
  const toggle = () => figure.classList.toggle('large');
  figure.addEventListener('click', toggle);
  figure.addEventListener('keydown', (event) => { if (event.key === 'Enter') toggle(); });
  return figure;
}

function drawThumbnails(run) {
  if (!run.thumbnails.length) {
    sayMissing('thumbnails', 'No images are given.');
    return;
  }
  const ages = run.thumbnails.flatMap((image) => list(image.tracks).map((track) => list(track)[0]));
  const oldest = quantile(ages, 0.95) ?? 0;
  document.getElementById('thumbnails').replaceChildren(...run.thumbnails.map((image) => thumbnail(image, oldest)));
  const place = document.getElementById('caption-images');
  if (ages.length) {
    const ramp = element('span', 'ramp');
    ramp.style.background = `linear-gradient(to right, ${ageScale.join(', ')})`;
    place.append('Where each feature came from in the last frames; new', ramp, `seen for ${Math.round(oldest)} frames or more. `);
  } else {
    place.append('No tracks are given. ');
  }
  place.append(element('span', 'screen-only', 'A click makes an image large.'));
}

/** Draws the data of the element #data. One part that fails does not take the others with it. */
async function drawReport() {
  let run;
  try {
    run = readRun(JSON.parse(document.getElementById('data').textContent));
  } catch (error) {
    tellError(`the data: ${error.message}`);
    document.documentElement.dataset.state = 'done';
    return;
  }
  document.title = run.title;
  document.getElementById('title').textContent = run.title;
  document.getElementById('origin').textContent = run.origin;
  if (run.appVersion) document.getElementById('app-version').textContent = `Written by ${run.appVersion}. `;
  const range = timeRange(run);
  const parts = {notice: drawNotice, figures: drawFigures, 'trajectory and landmarks': drawWay, position: drawPosition,
    speed: drawSpeed, attitude: drawAttitude, 'gyroscope bias': drawGyroBias, 'accelerometer bias': drawAccelBias,
    stages: drawStages, features: drawFeatures, events: drawEvents, thumbnails: drawThumbnails};
  for (const [name, part] of Object.entries(parts)) {
    try {
      await part(run, range);
    } catch (error) {
      tellError(`${name}: ${error.message}`);
    }
  }
  for (const id of run.trajectoryOnly ? ['biases', 'time', 'features', 'events', 'images'] : []) {
    document.getElementById(id).hidden = true;
  }
  document.documentElement.dataset.state = 'done';
}
