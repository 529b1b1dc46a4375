// Distances between two clicked places: measured, drawn, listed, and kept. A known one sets the scale.
import { type Vec3 } from 'playcanvas';
import { post } from './api';
import { element, iconButton, kIcons, make } from './dom';
import { type Messages } from './messages';
import { kMostNotes, type Measurement, type NoteKeeper } from './notes';
import { type Viewer } from './viewer';

const kDigits = 4; // of a coordinate: tenths of a millimetre in a scene in metres

/// The unit of lengths, as far as it is known.
export interface LengthScale {
  metres: number | null; // of a scene unit; null: nothing tells the scale
  estimated: boolean;    // the metres are a network's estimate
  scalable: boolean;     // a known length may set the scale
  given: boolean;        // one has
}

export class Measures {
  active = false;
  private first: Vec3 | null = null;
  private metres: number | null = null; // of a scene unit
  private estimated = false; // the metres are a network's
  private scalable = false; // a known length may set the scale

  /// `scaled`: the run has another scale.
  constructor(private viewer: Viewer, private keeper: NoteKeeper, private messages: Messages, private scaled: () => Promise<void>) {
    element('measures-clear').addEventListener('click', () => keeper.set({ measurements: [] }));
    element('scale-reset').addEventListener('click', () => void this.scale({ reset: true }));
  }

  toggle(): void {
    this.active = !this.active;
    this.first = null;
    element('measure').setAttribute('aria-pressed', String(this.active));
    this.draw();
    this.messages.show(this.active ? 'click two points to measure' : '', 'work');
  }

  /// A place of the y-up world was clicked; null: nothing was there.
  click(point: Vec3 | null): void {
    if (!point) { this.messages.show('nothing there to measure: click on a surface'); return; }
    if (!this.first) {
      this.first = point.clone();
      this.draw();
      this.messages.show('click the second point', 'work');
      return;
    }
    const place = (p: Vec3) => this.viewer.fromWorld(p, true).map((x) => Number(x.toFixed(kDigits)));
    const measured = { from: place(this.first), to: place(point) }, { measurements } = this.keeper.notes;
    this.messages.show(this.text(this.first.distance(point)), 'result');
    this.first = null;
    this.keeper.set({ measurements: [...measurements, measured].slice(-kMostNotes) });
  }

  /// The list, and the lines in the picture.
  show(scale: LengthScale): void {
    this.metres = scale.metres;
    this.estimated = scale.estimated;
    this.scalable = scale.scalable;
    const { measurements } = this.keeper.notes;
    element('measure-box').hidden = measurements.length === 0;
    element('scale-reset').hidden = !scale.scalable || !scale.given;
    const typing = this.asking && element('measures').childElementCount === measurements.length; // its row stays
    if (!typing) this.list();
    this.draw();
  }

  private list(): void {
    element('measures').replaceChildren(...this.keeper.notes.measurements.map((m) => this.row(m)));
  }

  /// A length is being typed.
  private get asking(): boolean { return element('measures').querySelector('form') !== null; }

  private row(m: Measurement): HTMLElement {
    const text = this.text(Math.hypot(...m.from.map((v, k) => v - m.to[k]))), row = make('li');
    row.append(make('span', 'class-name', text));
    if (this.scalable) row.append(iconButton(kIcons.pen, 'known', 'set the scale by its true length', text, () => { if (!this.asking) this.ask(m, text, row); }));
    row.append(iconButton(kIcons.bin, 'remove', 'forget', text,
      () => this.keeper.set({ measurements: this.keeper.notes.measurements.filter((other) => other !== m) })));
    return row;
  }

  /// Asks for the true length in the row of a measurement. Escape leaves the scale as it is.
  private ask(m: Measurement, text: string, row: HTMLElement): void {
    const form = make('form', 'row'), label = make('label', 'row', 'this is '), input = make('input'), button = make('button', '', 'set the scale');
    Object.assign(input, { type: 'number', min: '0.001', step: 'any', required: true, id: 'known-length', value: this.metres !== null ? parseFloat(text).toString() : '' });
    label.append(input, ' m');
    form.append(label, button);
    form.addEventListener('submit', (e) => { e.preventDefault(); void this.scale({ from: m.from, to: m.to, metres: input.valueAsNumber }); });
    form.addEventListener('keydown', (e) => { if (e.key === 'Escape') { e.stopPropagation(); row.replaceWith(this.row(m)); } });
    row.replaceChildren(form);
    input.select();
    input.focus();
  }

  private async scale(wanted: object): Promise<void> {
    try {
      const { factor } = await post<{ factor: number }>('/api/scale', wanted);
      this.list(); // nothing is typed any more, so that new lengths are shown
      await this.scaled();
      this.messages.show(`Lengths are multiplied by ${factor.toFixed(4)}. Sizes, plan and exports have this scale.`, 'result');
    } catch (error) { this.messages.error(error); }
  }

  private draw(): void {
    const points = this.keeper.notes.measurements.flatMap((m) => [this.viewer.toWorld(m.from), this.viewer.toWorld(m.to)]);
    this.viewer.setRuler(this.first ? [...points, this.first] : points);
  }

  private text(distance: number): string {
    if (this.metres === null) return `${distance.toFixed(3)} scene units`;
    return `${(distance * this.metres).toFixed(3)} m${this.estimated ? ' (estimated)' : ''}`;
  }
}
