// Distances between two clicked places: measured, drawn, listed, and kept.
import { type Vec3 } from 'playcanvas';
import { element, iconButton, kIcons, make } from './dom';
import { type Messages } from './messages';
import { kMostNotes, type NoteKeeper } from './notes';
import { type Viewer } from './viewer';

const kDigits = 4; // of a coordinate: tenths of a millimetre in a scene in metres

export class Measures {
  active = false;
  private first: Vec3 | null = null;
  private metric = false;

  constructor(private viewer: Viewer, private keeper: NoteKeeper, private messages: Messages) {
    element('measures-clear').addEventListener('click', () => keeper.set({ measurements: [] }));
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
  show(metric: boolean): void {
    this.metric = metric;
    const { measurements } = this.keeper.notes;
    element('measure-box').hidden = measurements.length === 0;
    element('measures').replaceChildren(...measurements.map((m) => {
      const text = this.text(Math.hypot(...m.from.map((v, k) => v - m.to[k]))), row = make('li');
      row.append(make('span', 'class-name', text), iconButton(kIcons.bin, 'remove', 'forget', text,
        () => this.keeper.set({ measurements: this.keeper.notes.measurements.filter((other) => other !== m) })));
      return row;
    }));
    this.draw();
  }

  private draw(): void {
    const points = this.keeper.notes.measurements.flatMap((m) => [this.viewer.toWorld(m.from), this.viewer.toWorld(m.to)]);
    this.viewer.setRuler(this.first ? [...points, this.first] : points);
  }

  private text(distance: number): string { return `${distance.toFixed(3)} ${this.metric ? 'm' : 'scene units'}`; }
}
