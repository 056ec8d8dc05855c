// Elements from code. Text is always text: nothing that a run directory holds is read as HTML.

/** h('button', {class: 'tool', onclick: f, 'aria-label': 'x'}, 'text', child, ...) */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/** "X_a" with what follows the underscore as an index. */
export function symbol(text) {
  const cut = text.indexOf('_');
  if (cut < 0) return h('span', { class: 'symbol' }, text);
  return h('span', { class: 'symbol' }, text.slice(0, cut), h('sub', {}, text.slice(cut + 1)));
}

/** Text in which symbols with an underscore have their index below the line. */
export function rich(text) {
  return text.split(/([A-Za-zΓτβ]+_[A-Za-z0-9,]+)/).map((part, k) => {
    const cut = part.indexOf('_');
    return k % 2 ? h('span', { class: 'inline' }, part.slice(0, cut), h('sub', {}, part.slice(cut + 1))) : part;
  });
}

export function cssColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Colour of the curves of all bodies beside those of species. */
export const kAllBodies = -1;

/** Name of the colour of the k-th curve, species or run. */
export function colourName(k) {
  return k === kAllBodies ? '--ink' : `--c${k % 8}`;
}

export function seriesColour(k) {
  return cssColour(colourName(k));
}

export function download(name, blob) {
  const link = h('a', { download: name, href: URL.createObjectURL(blob) });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export function downloadText(name, text) {
  download(name, new Blob([text], { type: 'text/csv;charset=utf-8' }));
}

/** Part of a file name. */
export function fileName(text) {
  return text.replace(/[^A-Za-z0-9._-]+/g, '-').replace(/^-+|-+$/g, '') || 'report';
}

/** A small button with a pictogram; `label` is what it is called. */
export function tool(label, text, onclick, attributes = {}) {
  return h('button', { type: 'button', class: 'tool', title: label, 'aria-label': label, onclick, ...attributes }, text);
}
