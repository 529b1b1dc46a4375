// Rays from the eye through points of the canvas, in the y-up world.
import { Vec3 } from 'playcanvas';
import { type Viewer } from './viewer';

/// Through a point of the window (CSS pixels); `direction`: unit.
export function rayAt(viewer: Viewer, x: number, y: number): { eye: Vec3; direction: Vec3 } {
  const box = viewer.canvas.getBoundingClientRect(), eye = viewer.camera.getPosition().clone();
  return { eye, direction: viewer.camera.camera!.screenToWorld(x - box.left, y - box.top, 10).sub(eye).normalize() };
}

/// The place of a level that is under a point of the window; null: none.
export function atHeight(viewer: Viewer, x: number, y: number, height: number): Vec3 | null {
  const { eye, direction } = rayAt(viewer, x, y), along = (height - eye.y) / direction.y;
  return Number.isFinite(along) && along > 0 ? eye.add(direction.mulScalar(along)) : null;
}
