// Small helpers for the elements of the page.
export const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;

/// An element with its class and text.
export function make<K extends keyof HTMLElementTagNameMap>(tag: K, className = '', text = ''): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text) made.textContent = text;
  return made;
}

/// A button with an icon, named by its title.
export function iconButton(icon: string, className: string, title: string, of: string, action: () => void): HTMLButtonElement {
  const button = make('button', className);
  button.type = 'button';
  button.innerHTML = icon;
  button.title = title;
  button.setAttribute('aria-label', `${title}: ${of}`);
  button.addEventListener('click', action);
  return button;
}

// Drawn here: not every system has a font with an eye.
const icon = (body: string) => `<svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true">${body}</svg>`;
const line = 'fill="none" stroke="currentColor" stroke-width="1.4" stroke-linejoin="round" stroke-linecap="round"';
export const kIcons = {
  eye: icon(`<path d="M1 8c3-5 11-5 14 0-3 5-11 5-14 0z" ${line}/><circle cx="8" cy="8" r="2" fill="currentColor"/>`),
  brush: icon(`<path d="M9 9 14 2M9 9c-3-1-5 1-5 3s-2 2-2 2c4 1 8-1 7-5z" ${line}/>`),
  pen: icon(`<path d="M3 13l1-3.5L11 2.5l2.5 2.5L6.5 12z" ${line}/>`),
  solo: icon(`<circle cx="8" cy="8" r="6" ${line}/><circle cx="8" cy="8" r="2.5" fill="currentColor"/>`),
  fly: icon(`<path d="M8 1v4M8 11v4M1 8h4M11 8h4" ${line}/><circle cx="8" cy="8" r="2.5" ${line}/>`),
  bin: icon(`<path d="M2.5 4h11M6 4V2h4v2M4 4l.7 10h6.6L12 4M6.5 7v4M9.5 7v4" ${line}/>`),
};
