// The classes of the scene: how many splats each has, shown or hidden, alone, or in another colour.
import { type RunState } from './api';
import { element, iconButton, kIcons, make } from './dom';
import { type ClassStyle } from './drawn_splats';

const kNoLabel = 65535;
/// Walls, ceiling, and what hangs on walls: cut away where it hides the room from outside.
const kShell = /^(wall|ceiling|door|window|windowpane|curtain|blind|painting|picture|mirror|screen door|poster|sconce)$/;

export class ClassList {
  readonly styles: ClassStyle[] = [];
  private solo = -1;

  /// `changed`: the styles are others. `edit`: an edit in words was asked for.
  constructor(private changed: () => void, private edit: (text: string) => void) {
    element('all').addEventListener('click', () => this.showAll());
  }

  build(labels: Uint16Array | null, state: RunState): void {
    const counts = new Map<number, number>();
    if (labels) for (const l of labels) counts.set(l, (counts.get(l) ?? 0) + 1);
    const known = new Map((state.classes ?? []).map((c) => [c.id, c]));
    const rows: HTMLElement[] = [];
    for (const [id, count] of [...counts].sort((a, b) => b[1] - a[1])) {
      if (id === kNoLabel) continue;
      const info = known.get(id), color = info?.color ?? [128, 128, 128], name = info?.name ?? `class ${id}`;
      this.styles[id] ??= { color: color as [number, number, number], visible: true, shell: kShell.test(name) };
      const row = make('li'), swatch = make('span', 'swatch'), label = make('span', 'class-name', name);
      row.dataset.label = String(id);
      swatch.style.background = `rgb(${color.join(',')})`;
      label.title = info?.synonyms?.join(', ') ?? '';
      row.append(swatch, label, make('span', 'count', count.toLocaleString('en')),
        iconButton(kIcons.eye, 'eye', 'show or hide', name, () => this.toggle(id)),
        iconButton(kIcons.solo, 'solo', 'show only this', name, () => this.showOnly(id)));
      if (state.editable && info) row.append(this.recolorButton(name));
      rows.push(row);
    }
    element('classes').replaceChildren(...rows);
    element('no-classes').hidden = rows.length > 0;
    this.mark();
  }

  showAll(): void {
    this.solo = -1;
    this.styles.forEach((s) => { s.visible = true; });
    this.apply();
  }

  private toggle(id: number): void {
    this.solo = -1;
    this.styles[id].visible = !this.styles[id].visible;
    this.apply();
  }

  private showOnly(id: number): void {
    this.solo = this.solo === id ? -1 : id;
    this.styles.forEach((s, i) => { s.visible = this.solo < 0 || i === this.solo; });
    this.apply();
  }

  private apply(): void {
    this.mark();
    this.changed();
  }

  private mark(): void {
    for (const row of element('classes').children as HTMLCollectionOf<HTMLElement>) {
      const id = Number(row.dataset.label);
      row.classList.toggle('hidden-class', !this.styles[id].visible);
      row.classList.toggle('solo-class', this.solo === id);
      row.querySelector('.eye')!.setAttribute('aria-pressed', String(this.styles[id].visible));
      row.querySelector('.solo')!.setAttribute('aria-pressed', String(this.solo === id));
    }
  }

  /// A colour that is chosen becomes an edit of the class.
  private recolorButton(name: string): HTMLElement {
    const label = make('label', 'recolor'), color = make('input');
    label.title = 'recolour';
    label.innerHTML = kIcons.brush;
    color.type = 'color';
    color.value = '#add8e6';
    color.setAttribute('aria-label', `recolour: ${name}`);
    color.addEventListener('change', () => this.edit(`recolor ${name} to ${color.value}`));
    label.append(color);
    return label;
  }
}
