// The objects of the room by name, with search: show or hide, fly to, delete.
import { element, iconButton, kIcons, make } from './dom';
import { sizeText, type SceneObject } from './scene_objects';
import { objectKey } from './drawn_splats';

export interface ObjectActions {
  fly(object: SceneObject): void;
  remove(object: SceneObject): void;
  point(object: SceneObject | null): void;  // the pointer or the focus is on a row
  hide(hidden: Set<string>): void;
}

export class ObjectList {
  objects: SceneObject[] = [];
  private hidden = new Set<string>();
  private metres: number | null = null;
  private editable = false;

  constructor(private actions: ObjectActions) {
    element('object-search').addEventListener('input', () => this.show());
    element('objects-all').addEventListener('click', () => { this.hidden.clear(); this.actions.hide(this.hidden); this.show(); });
  }

  build(objects: SceneObject[], metres: number | null, editable: boolean): void {
    this.objects = objects;
    this.metres = metres;
    this.editable = editable;
    this.show();
  }

  find(label: number, instance: number): SceneObject | null {
    return this.objects.find((o) => o.label === label && o.instance === instance) ?? null;
  }

  length(units: number): string { return this.metres !== null ? `${(units * this.metres).toFixed(2)} m` : `${units.toFixed(2)} units`; }
  size(object: SceneObject): string { return sizeText(object.size, this.metres); }

  private show(): void {
    const words = element<HTMLInputElement>('object-search').value.trim().toLowerCase();
    const found = this.objects.filter((o) => o.name.toLowerCase().includes(words));
    element('objects').replaceChildren(...found.map((o) => this.row(o)));
    element('object-box').hidden = this.objects.length === 0;
    element('object-count').textContent = found.length === this.objects.length ? `${found.length}` : `${found.length} of ${this.objects.length}`;
  }

  private row(object: SceneObject): HTMLElement {
    const row = make('li'), key = objectKey(object.label, object.instance), name = make('span', 'class-name', object.name);
    name.title = `${object.count.toLocaleString('en')} splats`;
    const eye = iconButton(kIcons.eye, 'eye', 'show or hide', object.name, () => {
      if (!this.hidden.delete(key)) this.hidden.add(key);
      row.classList.toggle('hidden-class', this.hidden.has(key));
      eye.setAttribute('aria-pressed', String(!this.hidden.has(key)));
      this.actions.hide(this.hidden);
    });
    eye.setAttribute('aria-pressed', String(!this.hidden.has(key)));
    row.classList.toggle('hidden-class', this.hidden.has(key));
    name.append(make('span', 'object-size', this.size(object)));
    row.append(name, eye, iconButton(kIcons.fly, 'fly', 'fly to', object.name, () => this.actions.fly(object)));
    if (this.editable) row.append(iconButton(kIcons.bin, 'remove', 'delete', object.name, () => this.actions.remove(object)));
    for (const [on, off] of [['pointerenter', 'pointerleave'], ['focusin', 'focusout']]) {
      row.addEventListener(on, () => this.actions.point(object));
      row.addEventListener(off, () => this.actions.point(null));
    }
    return row;
  }
}
