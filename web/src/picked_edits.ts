// The buttons of what was clicked: they edit it.
import { element } from './dom';
import { type EditPanel } from './edits';
import { type Selection } from './selection';

export function bindPickedEdits(selection: Selection, edits: EditPanel): void {
  const edit = (verb: string) => {
    const object = selection.name, color = element<HTMLInputElement>('picked-color').value;
    if (!object) return;
    selection.clear();
    void edits.apply(verb === 'recolor' ? `recolor ${object} to ${color}` : verb === 'delete' ? `delete ${object} --fill` : `${verb} ${object}`);
  };
  element('picked-color').addEventListener('change', () => edit('recolor'));
  for (const button of document.querySelectorAll<HTMLElement>('#picked-edits button')) button.addEventListener('click', () => edit(button.dataset.edit!));
}
