// Selecting by hand: tools over the picture, what they took, and the selections that have a name.
import { type RunState } from './api';
import { DrawTool } from './draw_tool';
import { shapeOf, splatsIn, type Point, type Tool } from './drawn_shape';
import { element, iconButton, kIcons, make } from './dom';
import { type Messages } from './messages';
import { type Splats } from './pick';
import { fetchPlaces, fetchSelections, removeSelection, renameSelection, saveSelection, type NamedSelection } from './selections_api';
import { splatViewOf } from './splat_view';
import { type Viewer } from './viewer';

type How = 'new' | 'add' | 'subtract';

const kSkin = 0.012; // of the room's diagonal: what is deeper in a surface is hidden; 8 cm in a room of 4 m by 5 m

export interface HandActions {
  state(): RunState;
  opened(on: boolean): void;                           // the tools are there, or gone
  picked(name: string, splats: number): void;          // a selection with a name is meant by the edit buttons
}

export class HandSelection {
  open = false;
  private draw: DrawTool;
  private how: How = 'new';
  private flags = new Uint8Array(0); // by place in the trained scene
  private count = 0;
  private list: NamedSelection[] = [];
  private asked = '';

  constructor(private viewer: Viewer, private messages: Messages, private actions: HandActions) {
    this.draw = new DrawTool(viewer.canvas, (points, keys) => this.take(points, keys.alt ? 'subtract' : keys.shift ? 'add' : this.how));
    for (const button of document.querySelectorAll<HTMLElement>('#select-bar [data-tool]')) button.addEventListener('click', () => { this.setTool(button.dataset.tool as Tool | 'look'); viewer.canvas.focus(); }); // arrows and Enter draw
    for (const button of document.querySelectorAll<HTMLElement>('#select-bar [data-how]')) button.addEventListener('click', () => this.setHow(button.dataset.how as How));
    const size = element<HTMLInputElement>('brush-size');
    size.addEventListener('input', () => { this.draw.radius = Number(size.value) / 2; });
    element('select-clear').addEventListener('click', () => this.clear());
    element('select-close').addEventListener('click', () => this.toggle());
    element('select').addEventListener('click', () => this.toggle());
    element('select-form').addEventListener('submit', (e) => { e.preventDefault(); void this.save(); });
  }

  /// Whether a drag on the picture draws.
  get drawing(): boolean { return this.open && this.draw.tool !== null; }

  /// Draws by an arrow key or Enter.
  key(key: string): void { this.draw.key(key); }

  /// Leaves the shape that is being drawn, or else the tools.
  escape(): void { if (!this.draw.cancel()) this.toggle(); }

  toggle(): void {
    this.open = !this.open;
    element('select-bar').hidden = !this.open;
    element('draw').toggleAttribute('hidden', !this.open);
    element('select').setAttribute('aria-pressed', String(this.open));
    this.setTool(this.open ? 'lasso' : 'look');
    if (!this.open) this.clear();
    this.actions.opened(this.open);
  }

  /// The run or its splats are others.
  async refresh(state: RunState, editable: boolean): Promise<void> {
    element('select').hidden = !editable;
    if (!editable && this.open) this.toggle();
    const now = editable ? `${state.version} ${state.selections}` : '';
    if (this.asked === now) return;
    this.asked = now;
    if (!editable) { this.show([]); return; }
    try { this.show(await fetchSelections()); } catch (e) { this.asked = ''; this.messages.error(e); }
  }

  /// Marks what is selected among the splats that are shown now.
  mark(): void {
    const splats = this.viewer.splats;
    if (!splats) return;
    if (this.flags.length !== splats.total) this.forget(splats);
    this.viewer.mark(this.count > 0 ? Uint8Array.from({ length: splats.count }, (_, i) => (this.placeOf(splats, i) >= 0 ? this.flags[this.placeOf(splats, i)] : 0)) : null);
    element('select-count').textContent = this.count > 0 ? `${this.count.toLocaleString('en')} splats` : 'nothing is selected';
    element<HTMLButtonElement>('select-save').disabled = this.count === 0;
    element<HTMLButtonElement>('select-clear').disabled = this.count === 0;
  }

  clear(): void {
    if (this.viewer.splats) this.forget(this.viewer.splats);
    this.mark();
  }

  private placeOf(splats: Splats, i: number): number { return splats.places ? splats.places[i] : i; }

  private forget(splats: Splats): void {
    this.flags = new Uint8Array(splats.total);
    this.count = 0;
  }

  private setTool(tool: Tool | 'look'): void {
    this.draw.tool = tool === 'look' ? null : tool;
    this.draw.cancel();
    for (const b of document.querySelectorAll<HTMLElement>('#select-bar [data-tool]')) b.setAttribute('aria-pressed', String(b.dataset.tool === tool));
    element('brush-row').hidden = tool !== 'brush';
    this.viewer.canvas.classList.toggle('drawing', this.drawing);
  }

  private setHow(how: How): void {
    this.how = how;
    for (const b of document.querySelectorAll<HTMLElement>('#select-bar [data-how]')) b.setAttribute('aria-pressed', String(b.dataset.how === how));
  }

  /// Takes the splats of a shape into the selection, or out of it.
  private take(points: Point[], how: How): void {
    const splats = this.viewer.splats, { drawn, room } = this.viewer;
    if (!splats) return;
    const through = element<HTMLInputElement>('select-through').checked;
    const found = splatsIn(splats, (i) => drawn.has(splats, i), splatViewOf(this.viewer), shapeOf(this.draw.tool!, points, this.draw.radius),
      through ? null : kSkin * (room?.diagonal ?? 1));
    if (how === 'new' || this.flags.length !== splats.total) this.forget(splats);
    for (const i of found) {
      const place = this.placeOf(splats, i), on = how === 'subtract' ? 0 : 1;
      if (place < 0 || this.flags[place] === on) continue;
      this.flags[place] = on;
      this.count += on ? 1 : -1;
    }
    this.mark();
    if (found.length === 0) this.messages.show('There is nothing in that shape.');
  }

  private async save(): Promise<void> {
    const field = element<HTMLInputElement>('select-name'), name = field.value.trim(), scene = this.actions.state().splats;
    if (this.count === 0 || !scene) { this.messages.show('Nothing is selected. Draw around something first.'); return; }
    await this.change(() => saveSelection(name, scene, this.flags), `"${name}" is kept. Edits know it by this name.`);
    if (this.list.some((s) => s.name === name)) { field.value = ''; this.actions.picked(name, this.count); }
  }

  /// Shows a selection, and lets the edit buttons mean it.
  private async choose(selection: NamedSelection): Promise<void> {
    const { splats } = this.viewer, scene = this.actions.state().splats;
    if (!splats || !scene) return;
    try {
      const flags = await fetchPlaces(selection.name, scene, splats.total);
      this.flags = flags;
      this.count = flags.reduce((sum, on) => sum + on, 0);
      this.actions.picked(selection.name, selection.gaussians);
      this.mark();
    } catch (e) { this.messages.error(e); }
  }

  private async change(action: () => Promise<NamedSelection[]>, told: string): Promise<void> {
    try {
      this.show(await action());
      this.messages.show(told);
    } catch (e) { this.messages.error(e); }
  }

  private show(list: NamedSelection[]): void {
    this.list = list;
    element('selection-box').hidden = list.length === 0;
    element('selections').replaceChildren(...list.map((s) => this.row(s)));
  }

  private row(s: NamedSelection): HTMLElement {
    const row = make('li'), open = make('button', 'class-name', s.name);
    open.type = 'button';
    open.title = s.usable ? 'show it' : 'of another training';
    open.disabled = !s.usable;
    open.addEventListener('click', () => void this.choose(s));
    row.append(open, make('span', 'count', s.usable ? s.gaussians.toLocaleString('en') : 'of another training'),
      iconButton(kIcons.pen, 'rename', 'rename', s.name, () => this.rename(s, open)),
      iconButton(kIcons.bin, 'remove', 'forget', s.name, () => void this.change(() => removeSelection(s.name), `"${s.name}" is forgotten. The room stays as it is.`)));
    return row;
  }

  /// Puts a field where the name is; Enter takes the new name, Escape the old one.
  private rename(s: NamedSelection, at: HTMLElement): void {
    const field = make('input', 'class-name');
    field.value = s.name;
    field.maxLength = 64;
    field.setAttribute('aria-label', `new name of ${s.name}`);
    let left = false;
    const leave = (to: string | null) => {
      if (left) return;
      left = true;
      field.replaceWith(at);
      if (to && to !== s.name) void this.change(() => renameSelection(s.name, to), `"${s.name}" is now "${to}".`);
    };
    field.addEventListener('keydown', (e) => {
      if (e.key === 'Enter') leave(field.value.trim());
      if (e.key === 'Escape') { e.stopPropagation(); leave(null); }
    });
    field.addEventListener('blur', () => leave(null));
    at.replaceWith(field);
    field.select();
  }
}
