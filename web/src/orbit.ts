// Camera by mouse, touch and keys: orbit around a target, pan, dolly. World is y up here.
import { Entity, Vec3 } from 'playcanvas';

export class Orbit {
  target = new Vec3();
  distance = 3;
  yaw = 0;   // degrees
  pitch = 0; // degrees, positive looks down
  enabled = true;
  private pointers = new Map<number, { x: number; y: number }>();
  private moved = 0;

  constructor(private camera: Entity, element: HTMLElement, private changed: () => void, clicked: (x: number, y: number) => void) {
    element.addEventListener('contextmenu', (e) => e.preventDefault());
    element.addEventListener('pointerdown', (e) => {
      element.setPointerCapture(e.pointerId);
      if (this.pointers.size === 0) this.moved = 0;
      this.pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
    });
    const up = (e: PointerEvent) => {
      const known = this.pointers.delete(e.pointerId);
      if (known && e.type === 'pointerup' && this.moved < 6 && this.pointers.size === 0 && e.button === 0) clicked(e.clientX, e.clientY);
    };
    element.addEventListener('pointerup', up);
    element.addEventListener('pointercancel', up);
    element.addEventListener('pointermove', (e) => {
      const before = this.pointers.get(e.pointerId);
      if (!before) return;
      const dx = e.clientX - before.x, dy = e.clientY - before.y;
      this.moved += Math.abs(dx) + Math.abs(dy);
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
    });
    element.addEventListener('wheel', (e) => { e.preventDefault(); this.dolly(Math.exp(e.deltaY * 0.001)); }, { passive: false });
  }

  lookFrom(eye: Vec3, target: Vec3): void {
    const d = new Vec3().sub2(eye, target);
    this.target.copy(target);
    this.distance = Math.max(0.1, d.length());
    this.yaw = (Math.atan2(d.x, d.z) * 180) / Math.PI;
    this.pitch = (Math.asin(Math.max(-1, Math.min(1, d.y / this.distance))) * 180) / Math.PI;
    this.apply();
  }

  /// Moves the target along the camera's axes, in shares of the distance.
  walk(right: number, up: number, forward: number): void {
    if (!this.enabled) return;
    const step = this.distance * 0.06;
    this.target.add(this.camera.right.clone().mulScalar(right * step));
    this.target.add(new Vec3(0, up * step, 0));
    this.target.add(this.camera.forward.clone().mulScalar(forward * step));
    this.apply();
  }

  turn(dx: number, dy: number): void {
    if (!this.enabled) return;
    this.yaw -= dx * 0.3;
    this.pitch = Math.max(-88, Math.min(88, this.pitch + dy * 0.3));
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
    this.distance = Math.max(0.05, this.distance * factor);
    this.apply();
  }

  apply(): void {
    const y = (this.yaw * Math.PI) / 180, p = (this.pitch * Math.PI) / 180;
    const offset = new Vec3(Math.sin(y) * Math.cos(p), Math.sin(p), Math.cos(y) * Math.cos(p)).mulScalar(this.distance);
    this.camera.setPosition(this.target.clone().add(offset));
    this.camera.lookAt(this.target);
    this.changed();
  }
}
