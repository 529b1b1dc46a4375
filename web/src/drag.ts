// Dragging the picked object over the floor: a preview while it moves, snapping to walls, and one edit at the end.
import { Vec3 } from 'playcanvas';
import { type CameraInfo } from './api';
import { type Splats } from './pick';
import { type Cut } from './room_box';
import { atHeight } from './view_rays';
import { type Viewer } from './viewer';

const kStart = 6;      // pixels that a press may wander before it drags
const kSnap = 0.05;    // metres between an object and a wall below which they touch
const kSnapShare = 0.01; // the same where the unit is not known: of the room's diagonal
const kStep = 0.05;    // metres, or the share kSnapShare of the diagonal, of an arrow key
const kTail = 0.02;    // share of splats at either end that are no part of an object's sides
const kLeast = 1e-3;   // scene units: a shorter move is none

type ObjectId = { label: number; instance: number };

export interface DragTarget {
  picked(): (ObjectId & { name: string }) | null; // the object that edits mean now
  cameras(): CameraInfo[];
  metres(): number | null; // of a scene unit
  apply(edit: string): Promise<void>;
  tell(text: string): void;
}

/// How far an object may be from a wall on its side: positive inside the room.
export function gapTo(wall: Cut, points: Vec3[]): number {
  const along = Float64Array.from(points, (p) => p.dot(wall.normal)).sort();
  return wall.offset - along[Math.min(along.length - 1, Math.floor((1 - kTail) * along.length))];
}

/// The shift with the gaps that are smaller than `reach` closed. Objects pushed into a wall come back to it.
export function snapped(shift: Vec3, walls: { normal: Vec3; gap: number }[], reach: number): Vec3 {
  const out = shift.clone();
  for (const wall of walls) {
    const towards = out.dot(wall.normal), left = wall.gap - towards;
    if (towards > 0 && left < reach) out.add(wall.normal.clone().mulScalar(left));
  }
  return out;
}

/// The words of a level move, as the server reads them (edit/move_objects.h). Their directions are those of a person at the
/// mean place of the training cameras, who looks at the middle of the object's box.
export function moveWords(name: string, shift: Vec3, middle: Vec3, viewer: Vec3): string {
  const toward = new Vec3(viewer.x - middle.x, 0, viewer.z - middle.z).normalize(), right = new Vec3().cross(Vec3.UP, toward);
  const number = (v: number) => String(Math.round(v * 1e4) / 1e4);
  return `move ${name} by ${number(shift.dot(right))},0,${number(shift.dot(toward))}`;
}

export class ObjectDrag {
  static readonly parts = { Vec3, gapTo, snapped, moveWords }; // for tests
  private held: { object: ObjectId & { name: string }; walls: { normal: Vec3; gap: number }[]; middle: Vec3 } | null = null;
  private grabbed: { x: number; y: number; place: Vec3; pointer: number; moves: boolean } | null = null;
  private shift = new Vec3();
  private byKeys = false;

  constructor(private viewer: Viewer, private target: DragTarget) {
    const { canvas } = viewer, first = { capture: true };
    canvas.addEventListener('pointerdown', (e) => this.press(e), first);
    canvas.addEventListener('pointermove', (e) => this.move(e), first);
    canvas.addEventListener('pointerup', (e) => this.release(e), first);
    canvas.addEventListener('pointercancel', () => this.cancel(), first);
    window.addEventListener('blur', () => this.cancel());
    window.addEventListener('keydown', (e) => this.key(e), first);
    window.addEventListener('keyup', (e) => { if (e.key === 'Shift' && this.byKeys) void this.finish(); });
  }

  get dragging(): boolean { return this.held !== null; }

  private take(object: ObjectId & { name: string }): boolean {
    const points = this.pointsOf(object);
    if (points.length === 0) return false;
    const low = points[0].clone(), high = points[0].clone();
    for (const p of points) { low.min(p); high.max(p); }
    const walls = (this.viewer.room?.walls ?? []).map((wall) => ({ normal: wall.normal, gap: gapTo(wall, points) }));
    this.held = { object, walls, middle: low.add(high).mulScalar(0.5) };
    this.shift.set(0, 0, 0);
    return true;
  }

  /// Places of an object's splats in the y-up world.
  private pointsOf(object: ObjectId): Vec3[] {
    const s: Splats | null = this.viewer.splats, out: Vec3[] = [];
    for (let i = 0; s?.labels && i < s.count; ++i) {
      if (s.labels[i] !== object.label || (object.instance > 0 && s.instances?.[i] !== object.instance)) continue;
      out.push(this.viewer.toWorld([s.centres[3 * i], s.centres[3 * i + 1], s.centres[3 * i + 2]]));
    }
    return out;
  }

  private reach(): number { return this.length(kSnap); }
  /// Metres as scene units, or where nothing tells the scale a share of the room.
  private length(metres: number): number {
    const unit = this.target.metres();
    return unit !== null ? metres / unit : kSnapShare * (this.viewer.room?.diagonal ?? 1);
  }

  private press(e: PointerEvent): void {
    if (this.grabbed && e.pointerId !== this.grabbed.pointer) { this.cancel(); return; } // two fingers turn the room
    const object = this.target.picked();
    if (!object || this.held || e.button !== 0 || e.shiftKey) return;
    const found = this.viewer.pick(e.clientX, e.clientY);
    if (!found || found.hit.label !== object.label || (object.instance > 0 && found.hit.instance !== object.instance)) return;
    this.grabbed = { x: e.clientX, y: e.clientY, place: found.point, pointer: e.pointerId, moves: false };
    this.viewer.canvas.setPointerCapture(e.pointerId);
    e.stopImmediatePropagation();
  }

  private move(e: PointerEvent): void {
    const g = this.grabbed;
    if (!g || e.pointerId !== g.pointer) return;
    e.stopImmediatePropagation();
    if (!g.moves && Math.hypot(e.clientX - g.x, e.clientY - g.y) < kStart) return;
    const object = this.target.picked();
    if (!g.moves && (!object || !this.take(object))) { this.cancel(); return; }
    g.moves = true;
    const place = atHeight(this.viewer, e.clientX, e.clientY, g.place.y);
    if (place) this.show(place.sub(g.place));
  }

  private show(shift: Vec3): void {
    shift.y = 0;
    this.shift = snapped(shift, this.held!.walls, this.reach());
    this.viewer.moveObject(this.held!.object, this.shift);
    this.target.tell(`${this.held!.object.name}: ${(this.shift.length() * (this.target.metres() ?? 1)).toFixed(2)} ${this.target.metres() !== null ? 'm' : 'units'}; Escape leaves it where it was`);
  }

  private release(e: PointerEvent): void {
    const g = this.grabbed;
    if (!g || e.pointerId !== g.pointer) return;
    e.stopImmediatePropagation();
    this.grabbed = null;
    if (g.moves) void this.finish();
  }

  private key(e: KeyboardEvent): void {
    if (e.key === 'Escape' && (this.held || this.grabbed)) {
      this.cancel();
      e.stopImmediatePropagation();
      return;
    }
    const side = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
    const owned = e.target instanceof HTMLElement && /^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName);
    if (!side || !e.shiftKey || e.ctrlKey || e.altKey || e.metaKey || owned || this.grabbed) return;
    const object = this.held?.object ?? this.target.picked();
    if (!object || (!this.held && !this.take(object))) return;
    e.preventDefault();
    e.stopImmediatePropagation();
    this.byKeys = true;
    const { camera } = this.viewer, level = (v: Vec3) => new Vec3(v.x, 0, v.z).normalize();
    const step = this.length(kStep);
    this.show(this.shift.clone().add(level(camera.right).mulScalar(side[0] * step)).add(level(camera.forward).mulScalar(side[1] * step)));
  }

  /// One edit for the whole way. The preview stays until the edited splats are there.
  private async finish(): Promise<void> {
    const held = this.held!, shift = this.shift.clone();
    this.held = null;
    this.byKeys = false;
    const places = this.target.cameras().filter((c) => c.split !== 'test').map((c) => this.viewer.toWorld(c.position));
    if (shift.length() < kLeast || places.length === 0) {
      this.viewer.moveObject(null);
      this.target.tell(places.length === 0 ? 'No camera of this room is known. Type the move instead.' : '');
      return;
    }
    const viewer = places.reduce((sum, p) => sum.add(p), new Vec3()).mulScalar(1 / places.length);
    await this.target.apply(moveWords(held.object.name, shift, held.middle, viewer));
    this.viewer.moveObject(null);
  }

  private cancel(): void {
    const moved = this.held !== null;
    this.held = this.grabbed = null;
    this.byKeys = false;
    if (!moved) return;
    this.viewer.moveObject(null);
    this.target.tell('');
  }
}
