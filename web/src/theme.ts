// Light or dark: as the system has it, or as was chosen here.
import { element } from './dom';

const kKey = 'aligngs-theme';

export function bindTheme(changed: (dark: boolean) => void): void {
  const system = matchMedia('(prefers-color-scheme: dark)');
  let chosen = '';
  try { chosen = localStorage.getItem(kKey) ?? ''; } catch { /* this browser keeps nothing */ }
  const apply = () => {
    const dark = chosen ? chosen === 'dark' : system.matches;
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    element('theme').setAttribute('aria-pressed', String(!dark));
    changed(dark);
  };
  system.addEventListener('change', apply);
  element('theme').addEventListener('click', () => {
    chosen = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    try { localStorage.setItem(kKey, chosen); } catch { /* for this visit alone */ }
    apply();
  });
  apply();
}
