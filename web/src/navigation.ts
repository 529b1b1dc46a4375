// Camera by mouse, touch and keys: orbit around a target, or walk through the room. World is y up here.
import { type Entity, Vec3 } from 'playcanvas';
import { type RoomBox } from './room_box';

export type Mode = 'orbit' | 'walk';
export interface Pose { eye: Vec3; target: Vec3 }

const kTurn = 0.3;             // degrees a pixel
const kKeyTurn = 70;           // degrees a second of the arrow keys
const kTap = 0.05;             // seconds of moving for a key that is only tapped
const kStroll = 0.22;          // of the room's diagonal a second: 1.4 m/s in a room of 4 m by 5 m
const kLeastDistance = 0.15;   // scene units between eye and target
const kMostDistance = 1.6;     // of the room's diagonal: farther off there is nothing to see
const kClick = 6;              // pixels that a click may wander
const kPause = 1000;           // milliseconds without a move, while a pointer is held, that count as rest
const kFromWall = 0.25;        // scene units between the eye and a wall while walking

/// Keys that move for as long as they are held: right, up, forward, turn to the left.
const kKeys: Record<string, [number, number, number, number]> = {
  w: [0, 0, 1, 0], s: [0, 0, -1, 0], a: [-1, 0, 0, 0], d: [1, 0, 0, 0], q: [0, -1, 0, 0], e: [0, 1, 0, 0],
  ArrowUp: [0, 0, 1, 0], ArrowDown: [0, 0, -1, 0], ArrowLeft: [0, 0, 0, 1], ArrowRight: [0, 0, 0, -1],
};

export class Navigation {
  mode: Mode = 'orbit';
  enabled = true;
  room: RoomBox | null = null;
  stick = { right: 0, forward: 0 }; // of the joystick, -1 to 1
  private target = new Vec3();
  private distance = 3;
  private yaw = 0;   // degrees
  private pitch = 0; // degrees, positive looks down
  private pointers = new Map<number, { x: number; y: number }>();
  private moved = 0;
  private dragged = 0; // time of the last drag
  private held = new Set<string>();
  private last = 0; // time of the last step of held keys, 0: none is held

  constructor(private camera: Entity, surface: HTMLElement, private changed: () => void, clicked: (x: number, y: number) => void) {
    surface.addEventListener('contextmenu', (e) => e.preventDefault());
    surface.addEventListener('pointerdown', (e) => {
      surface.setPointerCapture(e.pointerId);
      if (this.pointers.size === 0) this.moved = 0;
      this.pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
    });
    const up = (e: PointerEvent) => {
      const known = this.pointers.delete(e.pointerId);
      if (known && e.type === 'pointerup' && this.moved < kClick && this.pointers.size === 0 && e.button === 0) clicked(e.clientX, e.clientY);
    };
    surface.addEventListener('pointerup', up);
    surface.addEventListener('pointercancel', up);
    surface.addEventListener('pointermove', (e) => this.drag(e));
    surface.addEventListener('wheel', (e) => { e.preventDefault(); this.dolly(Math.exp(e.deltaY * 0.001)); }, { passive: false });
    window.addEventListener('keyup', (e) => this.held.delete(e.key.length === 1 ? e.key.toLowerCase() : e.key));
    window.addEventListener('blur', () => this.held.clear());
  }

  /// A key, the stick or a pointer moves the camera now.
  get moving(): boolean { return this.last > 0 || (this.pointers.size > 0 && this.moved >= kClick && performance.now() - this.dragged < kPause); }
  get pose(): Pose { return { eye: this.camera.getPosition().clone(), target: this.target.clone() }; }

  setMode(mode: Mode): void {
    const { eye, target } = this.pose;
    this.mode = mode;
    this.lookFrom(mode === 'walk' && this.room ? this.room.inside(eye, kFromWall) : eye, target);
  }

  lookFrom(eye: Vec3, target: Vec3): void {
    const d = new Vec3().sub2(eye, target);
    this.target.copy(target);
    this.distance = Math.max(kLeastDistance, d.length());
    this.yaw = (Math.atan2(d.x, d.z) * 180) / Math.PI;
    this.pitch = (Math.asin(Math.max(-1, Math.min(1, d.y / this.distance))) * 180) / Math.PI;
    this.apply();
  }

  /// A key that moves the camera goes down; false for other keys.
  press(key: string): boolean {
    if (!(key in kKeys)) return false;
    if (!this.held.has(key)) this.step(kTap, kKeys[key]); // also where pictures take longer than a key is held
    this.held.add(key);
    this.run();
    return true;
  }

  /// Goes on moving while a key or the joystick is held.
  run(): void {
    if (this.last > 0) return;
    this.last = performance.now();
    const step = (now: number) => {
      const seconds = Math.max(0, Math.min(0.1, (now - this.last) / 1000)); // a slow picture makes no leap
      this.last = now;
      const sum = [this.stick.right, 0, this.stick.forward, 0];
      for (const key of this.held) kKeys[key].forEach((v, k) => { sum[k] += v; });
      if (!this.enabled || sum.every((v) => v === 0)) { this.last = 0; return; }
      this.step(seconds, sum);
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  /// Motion by held keys in some seconds: right, up, forward, turn to the left.
  private step(seconds: number, [right, up, forward, left]: number[]): void {
    if (right || up || forward) this.walk(right * seconds, up * seconds, forward * seconds);
    if (left) this.turn(((this.mode === 'walk' ? left : -left) * kKeyTurn * seconds) / kTurn, 0);
  }

  /// Moves by seconds of strolling; walking keeps to the height of the eyes.
  walk(right: number, up: number, forward: number): void {
    if (!this.enabled) return;
    const pace = kStroll * (this.room?.diagonal ?? this.distance * 2);
    const ahead = this.camera.forward.clone(), side = this.camera.right.clone();
    if (this.mode === 'walk') { ahead.y = 0; ahead.normalize(); }
    const move = side.mulScalar(right * pace).add(ahead.mulScalar(forward * pace)).add(new Vec3(0, up * pace, 0));
    const eye = this.camera.getPosition().clone().add(move), kept = this.mode === 'walk' && this.room ? this.room.inside(eye, kFromWall) : eye;
    this.target.add(move).add(kept.sub(eye));
    this.apply();
  }

  turn(dx: number, dy: number): void {
    if (!this.enabled) return;
    const eye = this.camera.getPosition().clone(), sign = this.mode === 'walk' ? -1 : 1; // the head turns against the room
    this.yaw -= sign * dx * kTurn;
    this.pitch = Math.max(-88, Math.min(88, this.pitch + sign * dy * kTurn));
    if (this.mode === 'walk') this.target.copy(eye).sub(this.offset());
    this.apply();
  }

  pan(dx: number, dy: number): void {
    if (!this.enabled) return;
    const step = this.distance * 0.0015;
    this.target.add(this.camera.right.clone().mulScalar(-dx * step)).add(this.camera.up.clone().mulScalar(dy * step));
    this.apply();
  }

  dolly(factor: number): void {
    if (!this.enabled) return;
    if (this.mode === 'walk') { this.walk(0, 0, -Math.log(factor) * 2); return; }
    this.distance = Math.max(kLeastDistance, Math.min(this.room ? kMostDistance * this.room.diagonal : Infinity, this.distance * factor));
    this.apply();
  }

  private drag(e: PointerEvent): void {
    const before = this.pointers.get(e.pointerId);
    if (!before) return;
    const dx = e.clientX - before.x, dy = e.clientY - before.y;
    this.moved += Math.abs(dx) + Math.abs(dy);
    this.dragged = performance.now();
    const others = [...this.pointers].filter(([id]) => id !== e.pointerId).map(([, p]) => p);
    const gap = () => Math.hypot(before.x - others[0].x, before.y - others[0].y);
    if (others.length > 0) {
      const old = gap();
      before.x = e.clientX; before.y = e.clientY;
      this.pan(dx / 2, dy / 2);
      this.dolly(old / Math.max(1, gap()));
      return;
    }
    before.x = e.clientX; before.y = e.clientY;
    if (e.buttons & 2 || e.buttons & 4 || e.shiftKey) this.pan(dx, dy);
    else this.turn(dx, dy);
  }

  /// From the target to the eye.
  private offset(): Vec3 {
    const y = (this.yaw * Math.PI) / 180, p = (this.pitch * Math.PI) / 180;
    return new Vec3(Math.sin(y) * Math.cos(p), Math.sin(p), Math.cos(y) * Math.cos(p)).mulScalar(this.distance);
  }

  private apply(): void {
    this.camera.setPosition(this.target.clone().add(this.offset()));
    this.camera.lookAt(this.target);
    this.changed();
  }
}
