// The floor plan of room.json (docs/room.md), with the place of the camera. A click goes there.
import { Mat4, Vec3 } from 'playcanvas';
import { fetchRoom } from './api';
import { element } from './dom';
import { type MeasuredSizes } from './scene_objects';

interface Point { 0: number; 1: number }
interface RoomFile {
  units: string; frame: { world_to_room: number[][] }; scale: { source: string; units_per_scene_unit: number };
  walls: { id: string; from: Point; to: Point; length: number }[];
  openings: { kind: string; outline: number[][] }[];
  objects: { id: string; class: string; instance: number; centre: number[]; size: number[]; turn: number }[];
}

const kMargin = 0.4; // units of the room around the drawing
const kSvg = 'http://www.w3.org/2000/svg';

function draw(name: string, attributes: Record<string, string | number>, text = ''): SVGElement {
  const made = document.createElementNS(kSvg, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  if (text) made.textContent = text;
  return made;
}

/// The length of a wall, outside along it. `middle`: of the drawing; `size`: of the text.
function lengthOf(wall: RoomFile['walls'][number], middle: number[], size: number, unit: string): SVGElement {
  const x = (wall.from[0] + wall.to[0]) / 2, y = -(wall.from[1] + wall.to[1]) / 2, dx = wall.to[0] - wall.from[0], dy = wall.from[1] - wall.to[1];
  const out = Math.sign(dx * (y - middle[1]) - dy * (x - middle[0])) || 1, along = Math.hypot(dx, dy) || 1, angle = (Math.atan2(dy, dx) * 180) / Math.PI;
  const upright = angle > 91 ? angle - 180 : angle <= -89 ? angle + 180 : angle; // read from below or from the right
  const place = `translate(${x - (out * dy * size) / along} ${y + (out * dx * size) / along}) rotate(${upright})`;
  return draw('text', { transform: place, dy: 0.35 * size, class: 'plan-text', 'font-size': size }, `${wall.length.toFixed(2)}${unit}`);
}

export class Plan {
  sizes: MeasuredSizes = new Map();
  private room: RoomFile | null = null;
  private toRoom = new Mat4();
  private loaded = '';

  /// `go`: goes to a place of the plan, in the scene's own axes; the height of the eyes stays.
  constructor(private go: (place: (height: number) => number[]) => void) {
    element('plan-picture').addEventListener('click', (e) => this.clicked(e as unknown as MouseEvent));
  }

  /// Metres of a scene unit, by the room's scale; null: there is no room, or nothing tells its scale.
  get metres(): number | null { return this.room?.units === 'metres' ? this.room.scale.units_per_scene_unit : null; }
  /// Whether the metres are those of a network.
  get estimated(): boolean { return this.room?.scale.source === 'network estimate'; }
  /// Whether a user has given the scale.
  get given(): boolean { return this.room?.scale.source === 'given'; }

  /// Reads room.json when it is another one, and tells whether it was; the plan's button is there only with it.
  async refresh(path: string | null, version: string, edited: boolean): Promise<boolean> {
    element('plan-button').hidden = !path;
    if (!path) { const had = this.room !== null; this.room = null; this.sizes.clear(); this.loaded = ''; return had; }
    if (this.loaded === version) return false;
    const room = await fetchRoom(path, version, edited);
    if (!room) return false;
    this.room = room as RoomFile;
    this.loaded = version;
    const m = this.room.frame.world_to_room, rows = m.flat();
    // Row-major in the file, column-major here.
    this.toRoom.set([rows[0], rows[4], rows[8], 0, rows[1], rows[5], rows[9], 0, rows[2], rows[6], rows[10], 0, rows[3], rows[7], rows[11], 1]);
    const scale = this.room.scale.units_per_scene_unit;
    this.sizes = new Map(this.room.objects.map((o) => [`${o.class}#${o.instance}`, [o.size[0] / scale, o.size[1] / scale, o.size[2] / scale]]));
    this.show();
    return true;
  }

  /// Marks the camera: eye and direction in the scene's own axes.
  mark(eye: number[], ahead: number[]): void {
    const marker = document.getElementById('plan-camera');
    if (!this.room || !marker) return;
    const p = this.toRoom.transformPoint(new Vec3(...(eye as [number, number, number]))), d = this.toRoom.transformVector(new Vec3(...(ahead as [number, number, number])));
    marker.setAttribute('transform', `translate(${p.x} ${-p.y}) rotate(${(-Math.atan2(d.y, d.x) * 180) / Math.PI})`);
  }

  private show(): void {
    const room = this.room!, corners = room.walls.flatMap((w) => [w.from, w.to]);
    const xs = corners.map((p) => p[0]), ys = corners.map((p) => -p[1]);
    const left = Math.min(...xs) - kMargin, top = Math.min(...ys) - kMargin, width = Math.max(...xs) - left + kMargin, height = Math.max(...ys) - top + kMargin;
    const picture = element('plan-picture');
    picture.setAttribute('viewBox', `${left} ${top} ${width} ${height}`);
    const text = 0.03 * Math.max(width, height), unit = room.units === 'metres' ? ' m' : '';
    const parts: SVGElement[] = [];
    for (const o of room.objects) {
      const group = draw('g', { transform: `translate(${o.centre[0]} ${-o.centre[1]}) rotate(${-o.turn})` });
      group.append(draw('rect', { x: -o.size[0] / 2, y: -o.size[1] / 2, width: o.size[0], height: o.size[1], class: 'plan-object' }));
      parts.push(group, draw('text', { x: o.centre[0], y: -o.centre[1], class: 'plan-text', 'font-size': 0.8 * text }, o.class));
    }
    for (const w of room.walls) {
      parts.push(draw('line', { x1: w.from[0], y1: -w.from[1], x2: w.to[0], y2: -w.to[1], class: 'plan-wall', 'stroke-width': 0.25 * text }));
    }
    for (const o of room.openings) {
      const [a, b] = [o.outline[0], o.outline[1]];
      parts.push(draw('line', { x1: a[0], y1: -a[1], x2: b[0], y2: -b[1], class: `plan-${o.kind}`, 'stroke-width': 0.45 * text }));
    }
    const middle = [left + width / 2, top + height / 2];
    for (const w of room.walls) parts.push(lengthOf(w, middle, text, unit));
    parts.push(draw('path', { id: 'plan-camera', d: `M0 0 L${2.2 * text} ${-text} A${2.4 * text} ${2.4 * text} 0 0 1 ${2.2 * text} ${text} Z`, class: 'plan-camera' }));
    picture.replaceChildren(...parts);
  }

  private clicked(e: MouseEvent): void {
    if (!this.room) return;
    const picture = element('plan-picture') as unknown as SVGSVGElement, matrix = picture.getScreenCTM();
    if (!matrix) return;
    const p = new DOMPoint(e.clientX, e.clientY).matrixTransform(matrix.inverse()), back = this.toRoom.clone().invert();
    this.go((height) => { const v = back.transformPoint(new Vec3(p.x, -p.y, height)); return [v.x, v.y, v.z]; });
  }
}
