// Distance between two points that are clicked.
import { type Vec3 } from 'playcanvas';
import { element } from './dom';
import { type Messages } from './messages';
import { type Viewer } from './viewer';

export class Ruler {
  private points: Vec3[] | null = null;

  constructor(private viewer: Viewer, private messages: Messages) {}

  get on(): boolean { return this.points !== null; }

  toggle(): void {
    this.points = this.points ? null : [];
    element('measure').setAttribute('aria-pressed', String(this.on));
    this.viewer.setRuler([]);
    this.messages.show(this.on ? 'click two points to measure' : '', 'work');
  }

  /// A click on the room, or beside it.
  add(point: Vec3 | null, metric: boolean): void {
    if (!point) { this.messages.show('nothing there to measure: click on a surface'); return; }
    if (!this.points || this.points.length === 2) this.points = [];
    this.points.push(point);
    this.viewer.setRuler(this.points);
    if (this.points.length < 2) { this.messages.show('click the second point', 'work'); return; }
    const d = this.points[0].distance(this.points[1]);
    this.messages.show(metric ? `${d.toFixed(3)} m` : `${d.toFixed(3)} scene units`, 'result');
  }
}
