// Lines in the 3D view: cameras, the ruler.
import { type AppBase, Color, Vec3 } from 'playcanvas';
import { type CameraInfo } from './api';

export interface Line { points: Vec3[]; color: Color } // two points a stretch

const kRulerColor = new Color(1, 0.9, 0.1), kTestColor = new Color(1, 0.6, 0.9), kTrainColor = new Color(0.3, 0.8, 1);
const kArm = 0.03; // scene units: half of a cross at an end of the ruler

export class SceneLines {
  private groups = new Map<string, Line[]>();

  set(group: string, lines: Line[]): void { this.groups.set(group, lines); }
  draw(app: AppBase): void { for (const lines of this.groups.values()) for (const l of lines) app.drawLines(l.points, l.color); }
}

/// The pyramids of cameras; `size`: their depth, scene units.
export function frustaLines(cameras: CameraInfo[], size: number, toWorld: (p: number[]) => Vec3): Line[] {
  return cameras.map((c) => {
    const corner = (u: number, v: number) => {
      const q = [((u - 0.5) * c.width * size) / c.fx, ((v - 0.5) * c.height * size) / c.fy, size];
      return toWorld([0, 1, 2].map((k) => c.position[k] + c.rotation[k][0] * q[0] + c.rotation[k][1] * q[1] + c.rotation[k][2] * q[2]));
    };
    const eye = toWorld(c.position), k = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
    return { points: [eye, k[0], eye, k[1], eye, k[2], eye, k[3], k[0], k[1], k[1], k[2], k[2], k[3], k[3], k[0]], color: c.split === 'test' ? kTestColor : kTrainColor };
  });
}

/// Crosses at the ends of rulers, and a line between the two of each pair.
export function rulerLines(points: Vec3[]): Line[] {
  const arms = [new Vec3(kArm, 0, 0), new Vec3(0, kArm, 0), new Vec3(0, 0, kArm)];
  const lines = points.flatMap((p) => arms.map((d) => ({ points: [p.clone().sub(d), p.clone().add(d)], color: kRulerColor })));
  for (let k = 0; k + 1 < points.length; k += 2) lines.push({ points: [points[k], points[k + 1]], color: kRulerColor });
  return lines;
}
