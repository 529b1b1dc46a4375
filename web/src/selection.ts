// The object under the pointer, and the one that was clicked: they glow with their name, size and distance.
import { type Vec3 } from 'playcanvas';
import { type RunState } from './api';
import { element } from './dom';
import { type ObjectList } from './object_list';
import { type Hit } from './pick';
import { type Viewer } from './viewer';

const kNoLabel = 65535;
const kHoverEvery = 60;      // milliseconds between two looks under the pointer
const kHoverGlow = 0.25, kPickedGlow = 0.5;

export class Selection {
  name: string | null = null; // what the edit buttons mean: "pillow#2", or a class without objects
  private state!: RunState;
  picked: { label: number; instance: number } | null = null;
  private hovered = '';
  private next = 0;
  private editable = false;

  /// `cleared`: nothing is picked any more.
  constructor(private viewer: Viewer, private objects: ObjectList, private cleared: () => void) {
    viewer.canvas.addEventListener('pointerleave', () => this.hover(null));
    element('picked-close').addEventListener('click', () => this.clear());
  }

  /// An object is marked in the picture: the picked one, or that under the pointer.
  get glows(): boolean { return this.hovered !== ''; }

  refresh(state: RunState, editable: boolean): void { this.state = state; this.editable = editable; }

  /// The mouse is over a point of the canvas (CSS pixels of the window); null: over none.
  hover(at: { x: number; y: number } | null): void {
    const now = performance.now(), box = element('hovered');
    if (at && now < this.next) return;
    this.next = now + kHoverEvery;
    const found = at && this.viewer.pick(at.x, at.y);
    box.hidden = !found || found.hit.label === kNoLabel;
    if (at && found) {
      box.textContent = this.text(found.hit);
      const area = this.viewer.canvas.getBoundingClientRect(), x = at.x - area.left, y = at.y - area.top;
      box.style.left = `${Math.max(4, Math.min(area.width - box.offsetWidth - 4, x + 14))}px`;
      box.style.top = `${Math.max(4, Math.min(area.height - box.offsetHeight - 4, y + 14))}px`;
    }
    this.point(found && found.hit.label !== kNoLabel ? found.hit : null);
  }

  /// Lets an object glow while the pointer is on it, here or in the list; null: the picked one again.
  point(which: { label: number; instance: number } | null): void {
    const shown = which ?? this.picked, strength = shown && shown === this.picked ? kPickedGlow : kHoverGlow;
    const key = shown ? `${shown.label}#${shown.instance}#${strength}` : '';
    if (key === this.hovered) return;
    this.hovered = key;
    this.viewer.glow(shown, strength);
  }

  pick(found: { hit: Hit; point: Vec3 } | null): void {
    if (!found) { this.clear(); return; }
    const { hit } = found, info = this.state.classes?.find((c) => c.id === hit.label);
    const details = [hit.share > 0 ? `${Math.round(100 * hit.share)} % of the ray` : '', hit.confidence > 0 ? `confidence ${hit.confidence.toFixed(2)}` : ''];
    element('picked-text').textContent = [this.text(hit), ...details].filter(Boolean).join(', ');
    this.choose(info ? { label: hit.label, instance: hit.instance } : null);
    element('picked').hidden = false;
  }

  /// Marks an object as if it had been clicked.
  choose(which: { label: number; instance: number } | null): void {
    const info = which && this.state.classes?.find((c) => c.id === which.label);
    this.picked = which;
    this.name = which && info && this.editable ? (which.instance > 0 ? `${info.name}#${which.instance}` : info.name) : null;
    element('picked-edits').hidden = !this.name;
    this.hovered = '?';
    this.point(null);
  }

  /// Marks a selection that has a name as if it had been clicked.
  chooseNamed(name: string, splats: number): void {
    this.choose(null);
    this.name = this.editable ? name : null;
    element('picked-text').textContent = `${name}: ${splats.toLocaleString('en')} splats, selected by hand`;
    element('picked-edits').hidden = !this.name;
    element('picked').hidden = false;
  }

  clear(): void {
    this.cleared();
    element('picked').hidden = true;
    element('hovered').hidden = true;
    this.choose(null);
  }

  /// "pillow: object 2, 41 × 18 × 39 cm, 2.31 m away"
  private text(hit: Hit): string {
    const info = this.state.classes?.find((c) => c.id === hit.label), name = hit.label === kNoLabel ? 'no class' : info?.name ?? `class ${hit.label}`;
    const object = hit.instance > 0 ? this.objects.find(hit.label, hit.instance) : null;
    const parts = [hit.instance > 0 ? `object ${hit.instance}` : '', object ? this.objects.size(object) : '',
      `${this.objects.length(hit.distance)} away`];
    return `${name}: ${parts.filter(Boolean).join(', ')}`;
  }
}
