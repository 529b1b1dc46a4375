// Draws a shape over the picture with the mouse, a pen, a finger or the keyboard. Other buttons, the wheel and a second
// finger still move the camera.
import { element } from './dom';
import { type Point, type Tool } from './drawn_shape';

const kKeyStep = 12; // CSS pixels that an arrow key moves the mark
const kMark = 6;     // CSS pixels, radius of the mark of the keyboard
const kArrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const kLeastMove = 3; // CSS pixels between two points of a line

export class DrawTool {
  tool: Tool | null = null; // null: the pointer moves the camera
  radius = 30;              // of the brush, CSS pixels
  private points: Point[] = [];
  private pointer = -1;     // that draws
  private mark: Point | null = null;  // of the keyboard
  private corners: Point[] = [];      // that Enter has set

  /// `done` gets the points of a finished shape.
  constructor(private canvas: HTMLElement, private done: (points: Point[], keys: { shift: boolean; alt: boolean }) => void) {
    const place = canvas.parentElement!;
    const mine = (e: PointerEvent) => { e.stopImmediatePropagation(); e.preventDefault(); };
    place.addEventListener('pointerdown', (e) => {
      if (!this.tool || e.target !== canvas) return;
      if (this.pointer >= 0) { this.cancel(); return; } // a second finger: the camera, or nothing
      if (e.button !== 0) return;
      mine(e);
      this.cancel();
      this.pointer = e.pointerId;
      canvas.setPointerCapture(e.pointerId);
      this.points = [this.at(e)];
      this.show();
    }, true);
    place.addEventListener('pointermove', (e) => {
      if (e.pointerId !== this.pointer) { this.cursor(e); return; }
      mine(e);
      const p = this.at(e), last = this.points[this.points.length - 1];
      if (Math.hypot(p.x - last.x, p.y - last.y) >= kLeastMove) this.points.push(p);
      this.show();
      this.cursor(e);
    }, true);
    place.addEventListener('pointerup', (e) => {
      if (e.pointerId !== this.pointer) return;
      mine(e);
      const { points } = this;
      this.cancel();
      if (points.length > (this.tool === 'lasso' ? 2 : this.tool === 'rectangle' ? 1 : 0)) this.done(points, { shift: e.shiftKey, alt: e.altKey });
    }, true);
    place.addEventListener('pointercancel', (e) => { if (e.pointerId === this.pointer) this.cancel(); }, true);
    canvas.addEventListener('pointerleave', () => element('draw-cursor').setAttribute('r', '0'));
  }

  /// An arrow moves the mark. Enter sets a corner; at the second one a rectangle and a stroke end, at the last one again a lasso.
  key(key: string): void {
    const { clientWidth: width, clientHeight: height } = this.canvas, by = kArrows[key];
    this.mark ??= { x: width / 2, y: height / 2 };
    if (by) {
      const within = (v: number, most: number) => Math.max(0, Math.min(most, v));
      this.mark = { x: within(this.mark.x + kKeyStep * by[0], width), y: within(this.mark.y + kKeyStep * by[1], height) };
      if (this.tool === 'brush' && this.corners.length > 0) this.corners.push(this.mark);
    } else if (this.enter(this.mark)) {
      const points = this.corners;
      this.cancel();
      this.done(points, { shift: false, alt: false });
      return;
    }
    this.points = this.corners.length > 0 ? [...this.corners, this.mark] : [];
    this.show();
    this.ring(this.mark, this.tool === 'brush' ? this.radius : kMark);
  }

  /// Whether the shape is finished.
  private enter(at: Point): boolean {
    const { corners, tool } = this, last = corners[corners.length - 1], again = last?.x === at.x && last.y === at.y;
    if (tool === 'brush' && last) return true;
    if (again) return tool === 'lasso' && corners.length > 2;
    corners.push(at);
    return tool === 'rectangle' && corners.length === 2;
  }

  /// Leaves what is being drawn; false: nothing was.
  cancel(): boolean {
    const drew = this.points.length > 0;
    this.pointer = -1;
    this.points = [];
    this.corners = [];
    this.show();
    this.ring({ x: 0, y: 0 }, 0);
    return drew;
  }

  private at(e: PointerEvent): Point {
    const box = this.canvas.getBoundingClientRect();
    return { x: e.clientX - box.left, y: e.clientY - box.top };
  }

  private show(): void {
    const line = element('draw-line'), { points } = this, first = points[0], last = points[points.length - 1];
    const corners = this.tool === 'rectangle' && first ? [first, { x: last.x, y: first.y }, last, { x: first.x, y: last.y }] : points;
    line.setAttribute('d', corners.length ? `M${corners.map((p) => `${p.x} ${p.y}`).join('L')}${this.tool === 'brush' ? '' : 'Z'}` : '');
    line.setAttribute('class', this.tool === 'brush' ? 'stroke' : 'outline');
    line.style.strokeWidth = this.tool === 'brush' ? `${2 * this.radius}px` : '';
  }

  /// The size of the brush under the pointer.
  private cursor(e: PointerEvent): void { this.ring(this.at(e), this.tool === 'brush' && e.target === this.canvas ? this.radius : 0); }

  private ring(p: Point, radius: number): void {
    const ring = element('draw-cursor');
    ring.setAttribute('cx', String(p.x));
    ring.setAttribute('cy', String(p.y));
    ring.setAttribute('r', String(radius));
  }
}
