// The place that the photos look at.
import { Mat3, Vec3 } from 'playcanvas';
import { type CameraInfo } from './api';

const kLeastSpread = 0.05; // determinant per camera: with less all photos look in one direction

/// The point nearest to the optical axes of all cameras, in the scene's own axes; null where the axes are parallel.
export function lookedAt(cameras: CameraInfo[]): [number, number, number] | null {
  const a = [0, 0, 0, 0, 0, 0, 0, 0, 0], b = [0, 0, 0];
  for (const { position, rotation } of cameras) {
    const d = [rotation[0][2], rotation[1][2], rotation[2][2]];
    // Distances across the axis count: (I - d d^T) (p - position).
    for (let r = 0; r < 3; ++r) {
      for (let c = 0; c < 3; ++c) {
        const across = (r === c ? 1 : 0) - d[r] * d[c];
        a[3 * c + r] += across / cameras.length;
        b[r] += (across * position[c]) / cameras.length;
      }
    }
  }
  const [m0, m1, m2, m3, m4, m5, m6, m7, m8] = a;
  const determinant = m0 * (m4 * m8 - m7 * m5) - m3 * (m1 * m8 - m7 * m2) + m6 * (m1 * m5 - m4 * m2);
  if (cameras.length < 2 || Math.abs(determinant) < kLeastSpread) return null;
  const inverse = new Mat3();
  inverse.data.set([
    m4 * m8 - m5 * m7, m2 * m7 - m1 * m8, m1 * m5 - m2 * m4, m5 * m6 - m3 * m8, m0 * m8 - m2 * m6, m2 * m3 - m0 * m5,
    m3 * m7 - m4 * m6, m1 * m6 - m0 * m7, m0 * m4 - m1 * m3].map((v) => v / determinant));
  const p = inverse.transformVector(new Vec3(b[0], b[1], b[2]));
  return [p.x, p.y, p.z];
}
