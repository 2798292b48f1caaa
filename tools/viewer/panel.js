// The page around the two surfaces.

const style = `
  :root { color-scheme: light dark; --back: #f7f7f8; --card: #fff; --text: #1b1b1f; --soft: #5c5c66;
    --line: #d5d5dc; --accent: #0b57d0; --good: #116329; --fair: #8a5a00; --poor: #b3261e; --stage: #e8eaee; }
  @media (prefers-color-scheme: dark) { :root { --back: #16171a; --card: #1f2126; --text: #ececf1;
    --soft: #a6a8b2; --line: #3a3d45; --accent: #8ab4f8; --good: #6fcf8a; --fair: #f0b64c; --poor: #ff8a80;
    --stage: #2a2d33; } }
  * { box-sizing: border-box; }
  body { margin: 0; font: 15px/1.45 system-ui, sans-serif; background: var(--back); color: var(--text); }
  header, main, section { max-width: 1500px; margin: 0 auto; padding: 0 16px; }
  h1 { font-size: 20px; margin: 14px 0 2px; }
  h2 { font-size: 16px; margin: 18px 0 6px; }
  .stage { position: relative; height: min(62vh, 720px); background: var(--stage); border-radius: 8px;
    display: grid; grid-template-columns: 1fr 1fr; overflow: hidden; }
  .stage canvas { position: absolute; inset: 0; width: 100%; height: 100%; }
  .pane { position: relative; touch-action: none; cursor: grab; outline-offset: -3px; }
  .pane + .pane { border-left: 1px solid var(--line); }
  .pane b { position: absolute; left: 10px; top: 8px; font-weight: 600; pointer-events: none;
    background: var(--card); border-radius: 6px; padding: 1px 8px; }
  .pane[hidden] { display: none; }
  .stage.beside { grid-template-columns: 1fr 1fr 1fr; }
  .adding .pane { cursor: crosshair; }
  @media (max-width: 720px) { .stage { grid-template-columns: 1fr; grid-auto-rows: 1fr; height: 86vh; }
    .stage.beside { grid-template-columns: 1fr; }
    .pane + .pane { border-left: 0; border-top: 1px solid var(--line); } }
  .bar { display: flex; flex-wrap: wrap; gap: 6px; margin: 10px 0; align-items: center; }
  button { font: inherit; color: var(--text); background: var(--card); border: 1px solid var(--line);
    border-radius: 6px; padding: 4px 10px; cursor: pointer; }
  button[aria-pressed="true"] { border-color: var(--accent); box-shadow: inset 0 0 0 1px var(--accent);
    font-weight: 600; text-decoration: underline; }
  button:disabled { opacity: .5; cursor: default; }
  .about, .status { color: var(--soft); min-height: 1.5em; }
  .status { font-variant-numeric: tabular-nums; }
  table { border-collapse: collapse; width: 100%; background: var(--card); border-radius: 8px; }
  td, th { text-align: left; vertical-align: top; padding: 6px 10px; border-top: 1px solid var(--line); }
  tr:first-child > * { border-top: 0; }
  .good { color: var(--good); } .fair { color: var(--fair); } .poor { color: var(--poor); }
  .good::before { content: "✓ "; } .fair::before { content: "△ "; } .poor::before { content: "✗ "; }
  ul { margin: 4px 0; padding-left: 20px; }
  kbd { border: 1px solid var(--line); border-radius: 4px; padding: 0 5px; background: var(--card); }
`;

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else if (value !== false) made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

function toggle(name, about, pressed, press) {
  return element('button', { 'aria-pressed': String(pressed), title: about, onclick: press }, name);
}

function figures(data) {
  const levels = { good: 'good', fair: 'fair', poor: 'poor' };
  const rows = data.figures.map((f) =>
    element(
      'tr',
      {},
      element('th', {}, f.name),
      element('td', {}, f.value),
      element('td', { class: levels[f.level] }, f.text),
    ),
  );
  return element('table', {}, ...rows);
}

function inputs(data) {
  const said = (input) => [...input.notes, ...input.repairs];
  const rows = data.inputs.map((input) =>
    element(
      'tr',
      {},
      element('th', {}, input.role),
      element('td', {}, input.path),
      element('td', {}, `${input.counts.triangles ?? '?'} triangles`),
      element(
        'td',
        {},
        said(input).length > 0
          ? element('ul', {}, ...said(input).map((line) => element('li', {}, line)))
          : 'nothing had to be repaired',
      ),
    ),
  );
  return element('table', {}, ...rows);
}

/** Builds the page; `actions` are called by its controls. Returns what changes later. */
export function buildPanel(data, layers, overlays, actions) {
  document.head.append(element('style', {}, style));
  const canvas = element('canvas', { 'aria-hidden': 'true' });
  const margin = (map) => (map.margin === null ? '' : `, margin ${map.margin.toFixed(3)}`);
  const pane = (side, title) =>
    element(
      'div',
      { class: 'pane', id: side, tabindex: '0', role: 'img', 'aria-label': `${title} surface` },
      element('b', {}, title),
    );
  const panes = { source: pane('source', 'source'), target: pane('target', 'target') };
  if (data.maps.length > 1) {
    panes.other = pane('other', `runner-up${margin(data.maps[1])}`);
    panes.other.hidden = true;
  }
  const stage = element('div', { class: 'stage' }, canvas, ...Object.values(panes));
  const about = element('div', { class: 'about', id: 'about' });
  const status = element('div', { class: 'status', id: 'status', 'aria-live': 'polite' });
  const layerButtons = layers.map((layer, i) =>
    toggle(`${i + 1} ${layer.name}`, layer.about, i === 0, () => actions.layer(i)),
  );
  const overlayButtons = overlays.map((o) =>
    toggle(o.name, o.about, false, () => actions.overlay(o.key)),
  );
  const beside = toggle(
    'Runner-up beside it',
    'The best map that is another one, next to the chosen map',
    false,
    actions.beside,
  );
  beside.disabled = data.maps.length < 2;
  const link = toggle('Link cameras', 'Turn both together', true, actions.link);
  const up = element(
    'button',
    { title: "The axis of the files that points up", onclick: actions.up },
    'Up: y',
  );
  const add = toggle('Add landmark', 'Click a place on either surface', false, actions.add);
  const remove = element('button', { onclick: actions.remove, disabled: '' }, 'Delete landmark');
  const save = element('button', { onclick: actions.save, disabled: '' }, 'Save landmarks');
  const count = element('span', { class: 'about' });
  document.body.append(
    element('header', {}, element('h1', {}, data.title), about),
    element(
      'main',
      {},
      element('div', { class: 'bar', role: 'group', 'aria-label': 'colours' }, ...layerButtons),
      stage,
      status,
      element(
        'div',
        { class: 'bar', role: 'group', 'aria-label': 'overlays' },
        ...overlayButtons,
        beside,
        link,
        up,
      ),
      element(
        'div',
        { class: 'bar', role: 'group', 'aria-label': 'landmarks' },
        add,
        remove,
        save,
        count,
      ),
    ),
    element('section', {}, element('h2', {}, 'How good it is'), figures(data)),
    element('section', {}, element('h2', {}, 'What was read'), inputs(data)),
  );
  if (data.warnings.length > 0)
    document.body.append(
      element(
        'section',
        {},
        element('h2', {}, 'Warnings'),
        element('ul', {}, ...data.warnings.map((w) => element('li', {}, w))),
      ),
    );
  document.body.append(
    element(
      'section',
      {},
      element('h2', {}, 'Keys'),
      element(
        'p',
        {},
        ...[
          ['1-6', 'colours'],
          ['C A G M S', 'critical points, arcs, graph, matches, seams'],
          ['R', 'runner-up beside the chosen map'],
          ['L', 'link cameras'],
          ['U', 'another axis up'],
          ['N', 'new landmark'],
          ['Del', 'delete the chosen landmark'],
          ['W', 'save landmarks'],
        ].flatMap(([key, what]) => [element('kbd', {}, key), ` ${what}   `]),
      ),
      element(
        'p',
        { class: 'about' },
        'A landmark that you add starts where the map takes it; drag either end to where it belongs, ' +
          'save the file, and run again with --landmarks FILE. One or two settle left and right.',
      ),
    ),
  );
  const press = (button, pressed) => button.setAttribute('aria-pressed', String(pressed));
  return {
    canvas,
    stage,
    panes,
    setStatus: (text) => (status.textContent = text),
    showLayer: (i) => {
      layerButtons.forEach((b, k) => press(b, k === i));
      about.textContent = layers[i].about;
    },
    showOverlay: (key, on) => {
      press(overlayButtons[overlays.findIndex((o) => o.key === key)], on);
      if (on) about.textContent = overlays.find((o) => o.key === key).about;
    },
    showBeside: (on) => {
      press(beside, on);
      panes.other.hidden = !on;
      stage.classList.toggle('beside', on);
    },
    showUp: (axis) => (up.textContent = `Up: ${axis}`),
    showLink: (on) => press(link, on),
    showAdding: (on) => {
      press(add, on);
      stage.classList.toggle('adding', on);
    },
    showLandmarks: (number, chosen) => {
      count.textContent = number === 1 ? '1 landmark' : `${number} landmarks`;
      remove.disabled = chosen < 0;
      save.disabled = number === 0;
    },
  };
}
