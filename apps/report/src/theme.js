// Light or dark: as the system says, until the reader chooses.
import { h } from './dom.js';

const listeners = new Set();

/** Called after each change of colours, until what is returned is called. */
export function onThemeChange(listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

const system = window.matchMedia('(prefers-color-scheme: dark)');

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : system.matches;
}

export function themeSwitch() {
  const button = h('button', { type: 'button', class: 'tool theme', onclick: toggle });
  function show() {
    const other = isDark() ? 'light' : 'dark';
    button.textContent = isDark() ? '☀' : '☾';
    button.setAttribute('aria-label', `Switch to ${other} colours`);
    button.title = `Switch to ${other} colours`;
    for (const listener of listeners) listener();
  }
  function toggle() {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
    show();
  }
  system.addEventListener('change', show);
  show();
  return button;
}
