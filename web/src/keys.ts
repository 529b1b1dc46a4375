// Keys of the page, and the list of them in the help: one table, so that it lists what works here.
import { element, make } from './dom';

export interface Key {
  keys: string[];              // as KeyboardEvent.key, letters in lower case
  shown: string;               // in the help
  does: string;
  here?: () => boolean;        // whether it works now; always without it
  action: (key: string) => void;
}

/// Whether an element needs the key itself: text is typed, a slider or a list is moved, a button is pressed.
function owns(target: EventTarget | null, key: string): boolean {
  if (target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement) return true;
  if (target instanceof HTMLInputElement) return target.type !== 'range' || key.startsWith('Arrow');
  return (key === ' ' || key === 'Enter') && target instanceof HTMLElement && ['BUTTON', 'SUMMARY', 'A'].includes(target.tagName);
}

export function bindKeys(table: Key[]): void {
  window.addEventListener('keydown', (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || document.querySelector('dialog[open]')) return;
    const key = e.key.length === 1 ? e.key.toLowerCase() : e.key;
    if (owns(e.target, e.key)) {
      if (e.key === 'Escape') (e.target as HTMLElement).blur();
      return;
    }
    const found = table.find((k) => k.keys.includes(key) && (k.here?.() ?? true));
    if (!found) return;
    e.preventDefault();
    found.action(key);
  });
}

export function showKeys(table: Key[]): void {
  element('key-list').replaceChildren(...table.filter((k) => k.here?.() ?? true).flatMap((k) => [make('dt', '', k.shown), make('dd', '', k.does)]));
  element<HTMLDialogElement>('help').showModal();
}
