// The box of the room in the y-up world, and which of its sides are between the camera and the room.
import { Vec3 } from 'playcanvas';

const kAngles = 30;        // directions of walls that are tried, over a right angle
const kSample = 4000;
const kTail = 0.02;        // share of splats at either end that do not count: haze behind the walls
const kWall = 0.06;        // share of the box that a wall may be thick or bent
const kLeastShare = 0.1;     // of the way to a target, where the eye is at the wall itself
const kLeast = 1e-3;       // scene units

/// A side that is cut away: splats with dot(position, normal) > offset.
export interface Cut { normal: Vec3; offset: number }

export class RoomBox {
  private constructor(readonly axes: Vec3[], readonly low: number[], readonly high: number[]) {}

  /// From positions of splats in the y-up world; walls are along the box's sides.
  static of(points: Vec3[]): RoomBox | null {
    if (points.length < 16) return null;
    const step = Math.max(1, Math.floor(points.length / kSample)), sample = points.filter((_, i) => i % step === 0);
    const values = new Float32Array(sample.length);
    const range = (axis: Vec3): [number, number] => {
      for (let i = 0; i < sample.length; ++i) values[i] = sample[i].dot(axis);
      values.sort();
      return [values[Math.floor(kTail * values.length)], values[Math.floor((1 - kTail) * values.length)]];
    };
    let best: { axes: Vec3[]; area: number } | null = null;
    for (let k = 0; k < kAngles; ++k) {
      const a = (k / kAngles) * (Math.PI / 2), axes = [new Vec3(Math.cos(a), 0, Math.sin(a)), new Vec3(-Math.sin(a), 0, Math.cos(a))];
      const area = axes.map(range).reduce((product, [l, h]) => product * (h - l), 1);
      if (!best || area < best.area) best = { axes, area };
    }
    const axes = [best!.axes[0], Vec3.UP, best!.axes[1]], ranges = axes.map(range);
    return new RoomBox(axes, ranges.map((r) => r[0]), ranges.map((r) => r[1]));
  }

  get diagonal(): number { return Math.max(kLeast, Math.hypot(...this.axes.map((_, k) => this.high[k] - this.low[k]))); }
  get floor(): number { return this.low[1]; }
  get ceiling(): number { return this.high[1]; }

  /// Sides that the eye is beyond: what hides the room from there.
  cuts(eye: Vec3): Cut[] {
    const found: Cut[] = [];
    this.axes.forEach((axis, k) => {
      const at = eye.dot(axis), margin = kWall * (this.high[k] - this.low[k]);
      if (at > this.high[k] + margin) found.push({ normal: axis.clone(), offset: this.high[k] - margin });
      if (at < this.low[k] - margin) found.push({ normal: axis.clone().mulScalar(-1), offset: -(this.low[k] + margin) });
    });
    return found;
  }

  /// The walls: level directions out of the room, and how far the box reaches in each.
  get walls(): Cut[] {
    return [0, 2].flatMap((k) => [{ normal: this.axes[k].clone(), offset: this.high[k] }, { normal: this.axes[k].clone().mulScalar(-1), offset: -this.low[k] }]);
  }

  /// A place inside that is seen from `eye` in the direction of `target`: the target itself, or one before the wall.
  nearer(eye: Vec3, target: Vec3): Vec3 {
    const way = new Vec3().sub2(target, eye);
    let share = 1;
    this.axes.forEach((axis, k) => {
      const at = eye.dot(axis), along = way.dot(axis), left = (along > 0 ? this.high[k] : this.low[k]) - at;
      if (left * along > 0) share = Math.min(share, left / along);
    });
    return eye.clone().add(way.mulScalar(Math.max(kLeastShare, share)));
  }

  /// The nearest place inside, `margin` scene units off the walls.
  inside(p: Vec3, margin: number): Vec3 {
    const out = new Vec3();
    this.axes.forEach((axis, k) => {
      const half = (this.high[k] - this.low[k]) / 2, m = Math.min(margin, 0.8 * half);
      out.add(axis.clone().mulScalar(Math.max(this.low[k] + m, Math.min(this.high[k] - m, p.dot(axis)))));
    });
    return out;
  }
}
